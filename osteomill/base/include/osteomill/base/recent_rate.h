#pragma once

#include <limits>

namespace osteomill {

/// Counts events, and gives how many there were in the last completed second, 0 before. Reads no clock
/// itself. Safe in the haptic tick.
class RecentRate {
 public:
  void count() noexcept { ++count_; }
  /// Returns how many events a second were counted in the last completed second. Has to be called more often
  /// than once a second. `now_s` never goes back; the first second begins with the first call.
  double per_s(double now_s) noexcept {
    const double passed_s = now_s - period_start_s_;
    if (passed_s >= 1) {
      per_s_ = count_ / passed_s;
      period_start_s_ = now_s;
      count_ = 0;
    }
    return per_s_;
  }

 private:
  double period_start_s_ = -std::numeric_limits<double>::infinity();
  int count_ = 0;
  double per_s_ = 0;
};

}  // namespace osteomill
