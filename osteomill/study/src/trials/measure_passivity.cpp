#include "osteomill/study/measure_passivity.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "osteomill/study/match_stiffness.h"

namespace osteomill {

namespace {

constexpr double kSoftest_N_per_mm = 0.05;
constexpr double kStiffest_N_per_mm = 200;
constexpr double kWithin = 1.03;

}  // namespace

StiffnessLimit seek_stiffness_limit(const std::function<WallPressResult(double)>& press,
                                    double start_N_per_mm) {
  StiffnessLimit limit;
  // Returns true if the limit is higher; a wall that gives way is too soft.
  const auto is_below_limit = [&](double stiffness) {
    const WallPressResult result = press(stiffness);
    if (result.motion == WallMotion::decays && stiffness > limit.stiffness_N_per_mm) {
      limit.stiffness_N_per_mm = stiffness;
      limit.felt_N_per_mm = result.felt_N_per_mm;
    }
    return result.motion != WallMotion::persists;
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

namespace {

constexpr double kDampings_Ns_per_mm[] = {0.001, 0.002, 0.005, 0.010};
constexpr double kDelays_s[] = {0.3e-3, 1e-3, 2e-3};

}  // namespace

std::vector<TrialSettings> passivity_cases(const std::vector<AlgorithmDescription>& algorithms,
                                           const TrialSettings& settings) {
  std::vector<TrialSettings> cases;
  for (const AlgorithmDescription& algorithm : algorithms) {
    if (setting_of_option(algorithm, kStiffnessOption) == nullptr) continue;
    for (const double delay_s : kDelays_s) {
      for (const double damping : kDampings_Ns_per_mm) {
        TrialSettings& one = cases.emplace_back(settings);
        one.algorithm = algorithm;
        one.hand_and_device.handle.force_delay_s = delay_s;
        one.device_damping_Ns_per_mm = damping;
      }
    }
  }
  return cases;
}

WallPressResult press_on_wall(const TrialSettings& settings, const Volume& wall) {
  const auto algorithm = make_algorithm(settings.algorithm, settings.haptics);
  algorithm->prepare({&wall, settings.tool, settings.tick_s});
  return press_on_wall(*algorithm, settings.tool.burr_radius_mm,
                       {settings.hand_and_device.handle, settings.device_damping_Ns_per_mm, settings.tick_s});
}

PassivityRow measure_passivity(TrialSettings settings, const Volume& wall) {
  const AlgorithmId& algorithm = settings.algorithm.id;
  settings.haptics.named.push_back(
      {algorithm.name, setting_of_option(settings.algorithm, kStiffnessOption)->name, 0});
  const auto press_at = [&](double stiffness_N_per_mm) {
    settings.haptics.named.back().value = stiffness_N_per_mm;
    return press_on_wall(settings, wall);
  };
  const double damping = settings.device_damping_Ns_per_mm;
  const double delay_s = settings.hand_and_device.handle.force_delay_s;
  const double rule = passive_stiffness_rule_N_per_mm(damping, settings.tick_s, delay_s);
  return {algorithm, damping, delay_s, seek_stiffness_limit(press_at, rule), rule};
}

}  // namespace osteomill
