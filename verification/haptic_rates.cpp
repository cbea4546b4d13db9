#include <cmath>

#include <fmt/core.h>

#include "verification/sections.h"
#include "verification/trial_figures.h"

namespace osteomill::verification {

Section haptic_rates(const Bones& bones, const Effort& effort) {
  Section section{
      "Half and double the haptic rate",
      fmt::format(
          "Must hold: force above 20 Hz over its mean is at most 0.06, and the removed volume is that "
          "at 1 kHz within 5 %. On {}, push 1.5 N, seed 11.",
          bones.tooth_name),
      {"rate", "force above 20 Hz / mean", "torque step, N mm", "force step, N", "removed, mm3", ""},
      {},
      {}};
  const std::vector<double> rates_hz{1000, 500, 2000};
  std::vector<TrialVariant> variants;
  for (const double rate_hz : rates_hz)
    variants.push_back({.seed = 11, .phase_s = effort.phase_s, .tick_s = 1 / rate_hz});
  const std::vector<TrialFigures> figures = milling_figures(bones.tooth, variants);
  const double usual_mm3 = figures.front().metrics.removed_mm3;
  for (std::size_t n = 0; n < rates_hz.size(); ++n) {
    const RunMetrics& metrics = figures[n].metrics;
    section.add(
        {fmt::format("{:.0f} Hz", rates_hz[n]), figure(figures[n].hp_over_mean()),
         figure(metrics.torque_Nmm.step_max), figure(metrics.force_N.step_max), figure(metrics.removed_mm3)},
        figures[n].hp_over_mean() <= 0.06 && std::abs(metrics.removed_mm3 / usual_mm3 - 1) <= 0.05);
  }
  return section;
}

}  // namespace osteomill::verification
