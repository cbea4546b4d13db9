#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace osteomill {

/// What a long run tells whoever started it, in that one's thread; nothing where they do not say to whom.
struct RunEvents {
  /// What is being done, and which share of it.
  std::function<void(std::string_view what, double fraction_done)> progress = [](std::string_view, double) {};
  /// One line that people should see.
  std::function<void(const std::string& line)> warn = [](const std::string&) {};
  /// The burr has come into a no-go structure; one line.
  std::function<void(const std::string& line)> no_go = [](const std::string&) {};
};

}  // namespace osteomill
