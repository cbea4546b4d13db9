#pragma once

#include <limits>

namespace osteomill {

/// Event rate in the last completed second; 0 before. Does not read a clock. Safe in the haptic tick.
class RecentRate {
 public:
  void count() noexcept { ++count_; }
  /// Returns the number of events per second in the last completed second. Must be called more than once a
  /// second. `now_s` must not decrease; the first second starts with the first call.
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
