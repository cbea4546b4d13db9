#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace osteomill {

/// The reports of a long run to the caller who started it, in the caller's thread; by default they go
/// nowhere.
struct RunEvents {
  /// Is told what is being done, and which share of it.
  std::function<void(std::string_view what, double fraction_done)> progress = [](std::string_view, double) {};
  /// One line that people should see.
  std::function<void(const std::string& line)> warn = [](const std::string&) {};
  /// The burr has come into a no-go structure; one line.
  std::function<void(const std::string& line)> no_go = [](const std::string&) {};
};

}  // namespace osteomill
