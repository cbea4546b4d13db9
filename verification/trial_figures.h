#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/haptics/barrier_shell_counts.h"
#include "osteomill/study/metrics.h"
#include "osteomill/study/milling_trial.h"

namespace osteomill::verification {

/// Differences of a trial from the default one.
struct TrialVariant {
  std::string algorithm = default_algorithm().id.name;
  double push_N = 1.5;
  std::uint64_t seed = 1;
  double phase_s = 20;
  double tick_s = 1e-3;
  /// Draws the hand by the seed instead of using the default one.
  bool random_hand = false;
  /// If false, the hand makes the same motions without removing bone.
  bool spindle = true;
  /// Steps of the handle's encoder; 0 disables rounding.
  double encoder_mm = HandleSettings{}.position_step_mm;
  double encoder_rad = HandleSettings{}.rotation_step_rad;
  /// Adds the cutting reaction (CuttingReaction) to the wrench.
  bool cutting_reaction = false;
  /// Cuts by the chip law with a surgical drill, with cutting reaction and drag.
  bool by_chips = false;
  std::vector<HapticSettings::Named> named = {};
  MillingTool tool = {};
};

/// Figures of one algorithm's milling phase in the test of section 8.2.
struct TrialFigures {
  RunMetrics metrics;
  /// Removed volume / (kappa times the integral of the paying part of the burr's force); NaN with the chip
  /// law.
  double paid_share = 0;
  /// Amplitude of the torque at half the haptic rate, in the worst 0.1 s of leaning.
  double half_rate_Nmm = 0;
  /// Set for barrier-shell only.
  std::optional<barrier_shell::Counts> counts;
  /// Time per tick for milling and the updates that follow a change of the volume, us.
  Distribution milling_us;

  double hp_over_mean() const { return metrics.force_N.hp_rms / metrics.force_N.mean; }
};

/// Runs the milling phase on a copy of the bone, from its top downwards. Throws std::invalid_argument if the
/// settings contradict each other, InputError if the bone has no entry for the tool.
TrialFigures milling_figures(const Volume& bone, const TrialVariant& variant);

/// Returns the figures of all variants, in their order. Runs one trial per core at a time.
std::vector<TrialFigures> milling_figures(const Volume& bone, const std::vector<TrialVariant>& variants);

}  // namespace osteomill::verification
