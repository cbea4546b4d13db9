#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace osteomill {

/// What a long run tells whoever started it, in that one's thread. Any of them may be empty.
struct RunEvents {
  /// What is being done, and which share of it.
  std::function<void(std::string_view what, double fraction_done)> progress;
  /// One line that people should see.
  std::function<void(const std::string& line)> warning;
  /// The burr has come into a no-go structure; one line.
  std::function<void(const std::string& line)> no_go;

  void tell_progress(std::string_view what, double fraction_done) const {
    if (progress) progress(what, fraction_done);
  }
  void warn(const std::string& line) const {
    if (warning) warning(line);
  }
  void tell_no_go(const std::string& line) const {
    if (no_go) no_go(line);
  }
};

}  // namespace osteomill
