#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace osteomill {

/// Callbacks of a long run; by default they do nothing. `run_trials` calls `progress` on its worker threads,
/// one call at a time.
struct RunEvents {
  /// Called with the current work and the fraction of it that is done, 0 to 1.
  std::function<void(std::string_view what, double fraction_done)> progress = [](std::string_view, double) {};
  /// Called with a line to show to the user.
  std::function<void(const std::string& line)> warn = [](const std::string&) {};
  /// Called with a line when the burr enters a no-go structure.
  std::function<void(const std::string& line)> no_go = [](const std::string&) {};
};

}  // namespace osteomill
