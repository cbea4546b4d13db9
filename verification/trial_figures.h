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

/// How a trial differs from the default one.
struct TrialVariant {
  std::string algorithm = default_algorithm().id.name;
  double push_N = 1.5;
  std::uint64_t seed = 1;
  double phase_s = 20;
  double tick_s = 1e-3;
  /// A hand drawn by the seed instead of the default one.
  bool random_hand = false;
  /// False lets the hand go through its motions without removing bone.
  bool spindle = true;
  /// The steps of the handle's encoder; 0 reads without rounding.
  double encoder_mm = HandleSettings{}.position_step_mm;
  double encoder_rad = HandleSettings{}.rotation_step_rad;
  /// True has the hand feel what cutting does to the burr (CuttingReaction).
  bool cutting_reaction = false;
  /// True cuts by chips with a surgical drill, and has the hand feel the reaction and the drag.
  bool by_chips = false;
  std::vector<HapticSettings::Named> named = {};
  MillingTool tool = {};
};

/// One algorithm's milling in the test of section 8.2.
struct TrialFigures {
  RunMetrics metrics;
  /// Removed volume / (kappa times the integral of the paying part of the burr's force); with chips not a
  /// number.
  double paid_share = 0;
  /// The amplitude of the torque at half the haptic rate, in the worst 0.1 s of leaning.
  double half_rate_Nmm = 0;
  /// Counts of barrier-shell; none for other algorithms.
  std::optional<barrier_shell::Counts> counts;
  /// Time of each tick's milling, with everything that follows the volume, us.
  Distribution milling_us;

  double hp_over_mean() const { return metrics.force_N.hp_rms / metrics.force_N.mean; }
};

/// Runs the milling phase on a copy of the bone, from its top downwards. Throws std::invalid_argument if
/// settings do not go together, InputError if the bone has no place to enter.
TrialFigures milling_figures(const Volume& bone, const TrialVariant& variant);

/// The figures of all variants, in their order, as many at a time as there are cores.
std::vector<TrialFigures> milling_figures(const Volume& bone, const std::vector<TrialVariant>& variants);

}  // namespace osteomill::verification
