#include "osteomill/study/match_stiffness.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/study/wall_press.h"

namespace osteomill {

namespace {

constexpr double kWithin = 0.01;
constexpr double kApart = 1.0005;
constexpr int kMaxPresses = 40;
constexpr double kSoftest_N_per_mm = 0.05;
constexpr double kStiffest_N_per_mm = 200;

// One end of the remaining interval.
struct SearchBound {
  double stiffness_N_per_mm;
  /// Nothing if it has not been pressed.
  std::optional<double> felt_N_per_mm = std::nullopt;
};

// Returns why the interval does not contain the wanted stiffness.
std::string reason(const SearchBound& low, const SearchBound& high) {
  if (low.felt_N_per_mm == 0.0 && high.felt_N_per_mm) {
    return fmt::format("the softest that carries the press, {:.4g}, is felt as {:.4g}",
                       high.stiffness_N_per_mm, *high.felt_N_per_mm);
  }
  if (low.felt_N_per_mm && high.felt_N_per_mm) {
    return fmt::format(
        "at a stiffness of {:.4g} that leaps from {:.3g} to {:.3g}, as its force rises in steps",
        low.stiffness_N_per_mm, *low.felt_N_per_mm, *high.felt_N_per_mm);
  }
  const SearchBound& last = low.felt_N_per_mm ? low : high;
  return fmt::format("with a stiffness of {:.4g} it is felt as {:.4g}", last.stiffness_N_per_mm,
                     last.felt_N_per_mm.value_or(0));
}

}  // namespace

double felt_stiffness_N_per_mm(const MillingSetup& setup, const Volume& wall) {
  const auto made = make_algorithm(setup.algorithm, setup.haptics);
  made->prepare({&wall, setup.tool, setup.tick_s});
  WallPress press;
  press.tick_s = setup.tick_s;
  return press_slowly_on_wall(*made, setup.tool.burr_radius_mm, press);
}

HapticSettings::Named match_felt_stiffness(double felt_N_per_mm, MillingSetup setup, const Volume& wall) {
  const AlgorithmDescription& algorithm = setup.algorithm;
  const SettingDescription* setting = setting_of_option(algorithm, kStiffnessOption);
  if (setting == nullptr) {
    throw std::invalid_argument(algorithm.id.name + " has no stiffness that could be matched");
  }
  const double softest = std::max(kSoftest_N_per_mm, setting->range.min);
  const double stiffest = std::min(kStiffest_N_per_mm, setting->range.max);
  std::vector<HapticSettings::Named>& named = setup.haptics.named;
  for (const SettingDescription& value : setting_values(algorithm, setup.haptics)) {
    if (value.name != setting->name) continue;
    named.push_back({algorithm.id.name, setting->name, std::clamp(value.value, softest, stiffest)});
  }
  double& stiffness = named.back().value;
  SearchBound low{softest}, high{stiffest};
  for (int n = 0; n < kMaxPresses && high.stiffness_N_per_mm > kApart * low.stiffness_N_per_mm; ++n) {
    const double felt = felt_stiffness_N_per_mm(setup, wall);
    if (std::abs(felt - felt_N_per_mm) <= kWithin * felt_N_per_mm) return named.back();
    (felt < felt_N_per_mm ? low : high) = {stiffness, felt};
    // Felt stiffness is usually proportional to the setting; bisects if that leads outside the interval.
    const double proportional = felt > 0 ? stiffness * felt_N_per_mm / felt : 0;
    const bool is_within = proportional > low.stiffness_N_per_mm && proportional < high.stiffness_N_per_mm;
    stiffness =
        is_within && n % 4 != 3 ? proportional : std::sqrt(low.stiffness_N_per_mm * high.stiffness_N_per_mm);
  }
  throw std::invalid_argument(fmt::format("{} cannot be felt as {:.4g} N/mm on a flat wall; {}",
                                          algorithm.id.name, felt_N_per_mm, reason(low, high)));
}

}  // namespace osteomill
