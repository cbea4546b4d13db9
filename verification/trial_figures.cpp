#include "verification/trial_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "osteomill/milling/cutting_reaction.h"
#include "osteomill/session/milling_entry.h"
#include "osteomill/volume/bone_densities.h"

#include "verification/in_parallel.h"

namespace osteomill::verification {

namespace {

TrialSettings settings_of(const TrialVariant& variant) {
  TrialSettings settings;
  settings.algorithm = algorithm_named(variant.algorithm);
  settings.tick_s = variant.tick_s;
  settings.tool = variant.tool;
  settings.cutting_reaction = variant.cutting_reaction;
  settings.haptics.named = variant.named;
  OperatorSettings& operator_settings = settings.hand_and_device;
  operator_settings.seed = variant.seed;
  if (variant.random_hand) operator_settings.hand = random_hand(variant.seed);
  operator_settings.hand.push_N = variant.push_N;
  operator_settings.script.milling_s = variant.phase_s;
  settings.spindle = variant.spindle;
  if (variant.by_chips) {
    settings.law = CuttingLaw::chips;
    settings.handpiece = Handpiece::surgical;
    settings.cutting_reaction = settings.drag = true;
  }
  operator_settings.handle.position_step_mm = variant.encoder_mm;
  operator_settings.handle.rotation_step_rad = variant.encoder_rad;
  return settings;
}

// Returns the amplitude of the component that alternates from tick to tick, in the worst window.
double half_rate_Nmm(const std::vector<TickRecord>& records, double tick_s) {
  constexpr double kWindow_s = 0.1, kLeaning_Nmm = 1;
  const auto window = static_cast<std::size_t>(std::lround(kWindow_s / tick_s));
  const auto torque = [&](std::size_t n) -> const Vec3& { return records[n].wrench.torque_Nmm; };
  double worst_Nmm = 0;
  for (std::size_t first = 1; first + window < records.size(); first += window) {
    Vec3 sum_Nmm = Vec3::Zero();
    bool leans = true;
    for (std::size_t n = first; n < first + window; ++n) {
      leans = leans && torque(n).norm() > kLeaning_Nmm;
      const Vec3 alternating_Nmm = 0.25 * (2 * torque(n) - torque(n - 1) - torque(n + 1));
      sum_Nmm += (n % 2 == 0 ? 1 : -1) * alternating_Nmm;
    }
    if (leans) worst_Nmm = std::max(worst_Nmm, sum_Nmm.norm() / static_cast<double>(window));
  }
  return worst_Nmm;
}

}  // namespace

TrialFigures milling_figures(const Volume& bone, const TrialVariant& variant) {
  const TrialSettings settings = settings_of(variant);
  MillingTrial trial(bone, estimate_densities(bone), place_entry(bone, settings.tool), settings);
  const MillingSettings milling = milling_settings(settings);
  Recording recording;
  recording.description.tick_period_s = variant.tick_s;
  std::vector<double> milling_us;
  double paid_for_mm3 = 0;
  for (MillingTrial::Tick tick = trial.tick(); tick.milling_phase; tick = trial.tick()) {
    recording.records.push_back(tick.record);
    milling_us.push_back(tick.record.milling_us);
    const Vec3 paying_N =
        paying_force_W_N(milling, tick.record.X_WT, tick.record.burr_force_W_N, tick.record.spindle_on);
    paid_for_mm3 += milling.removal_rate_mm3_per_Ns * paying_N.norm() * variant.tick_s;
  }
  TrialFigures figures;
  figures.metrics = run_metrics(recording);
  figures.paid_share = variant.by_chips ? std::numeric_limits<double>::quiet_NaN()
                                        : figures.metrics.removed_mm3 / paid_for_mm3;
  figures.half_rate_Nmm = half_rate_Nmm(recording.records, variant.tick_s);
  if (const auto* counts = barrier_shell::counts_of(trial.algorithm())) figures.counts = *counts;
  figures.milling_us = distribution_of(milling_us);
  return figures;
}

std::vector<TrialFigures> milling_figures(const Volume& bone, const std::vector<TrialVariant>& variants) {
  std::vector<TrialFigures> figures(variants.size());
  in_parallel(variants.size(), [&](std::size_t n) { figures[n] = milling_figures(bone, variants[n]); });
  return figures;
}

}  // namespace osteomill::verification
