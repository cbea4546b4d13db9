#include "osteomill/experiment/stiffness_limit.h"

#include <algorithm>
#include <cmath>

namespace osteomill {

namespace {

constexpr double kSoftest_N_per_mm = 0.05;
constexpr double kStiffest_N_per_mm = 200;
constexpr double kWithin = 1.03;

}  // namespace

StiffnessLimit seek_stiffness_limit(const std::function<WallPressResult(double)>& press,
                                    double start_N_per_mm) {
  StiffnessLimit limit;
  // True where the limit lies above: what gives way is too soft.
  const auto is_below_limit = [&](double stiffness) {
    const WallPressResult result = press(stiffness);
    if (result.motion == WallMotion::dies_out && stiffness > limit.stiffness_N_per_mm) {
      limit.stiffness_N_per_mm = stiffness;
      limit.felt_N_per_mm = result.felt_N_per_mm;
    }
    return result.motion != WallMotion::goes_on;
  };
  double low = std::clamp(start_N_per_mm, kSoftest_N_per_mm, kStiffest_N_per_mm);
  double high = low;
  if (is_below_limit(low)) {
    do {
      if (high >= kStiffest_N_per_mm) {
        if (limit.stiffness_N_per_mm > 0) limit.kind = StiffnessLimit::Kind::above_all;
        return limit;
      }
      low = high;
      high = std::min(2 * high, kStiffest_N_per_mm);
    } while (is_below_limit(high));
  } else {
    do {
      if (low <= kSoftest_N_per_mm) return limit;
      high = low;
      low = std::max(0.5 * low, kSoftest_N_per_mm);
    } while (!is_below_limit(low));
  }
  while (high > kWithin * low) {
    const double middle = std::sqrt(low * high);
    (is_below_limit(middle) ? low : high) = middle;
  }
  if (limit.stiffness_N_per_mm > 0) limit.kind = StiffnessLimit::Kind::found;
  return limit;
}

double passive_stiffness_rule_N_per_mm(double damping_Ns_per_mm, double tick_s, double delay_s) {
  return 2 * damping_Ns_per_mm / (tick_s + 2 * delay_s);
}

}  // namespace osteomill
