#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace osteomill {

/// The reports of a long run to the caller who started it, in the caller's thread; by default they go
/// nowhere.
struct RunEvents {
  /// Called with what is being done, and the share of it that is done, 0 to 1.
  std::function<void(std::string_view what, double fraction_done)> progress = [](std::string_view, double) {};
  /// Called with a line that people should see.
  std::function<void(const std::string& line)> warn = [](const std::string&) {};
  /// Called with a line if the burr has come into a no-go structure.
  std::function<void(const std::string& line)> no_go = [](const std::string&) {};
};

}  // namespace osteomill
