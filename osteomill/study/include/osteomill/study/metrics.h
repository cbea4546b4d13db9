#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/base/distribution.h"
#include "osteomill/base/field.h"
#include "osteomill/recording/recording.h"

namespace osteomill {

/// Minimum rate of a milling loop with a target of 1000 Hz (paper, section 8.1): at most 5 % of the ticks
/// are lost.
inline constexpr double kMinRate_hz = 950.0;
/// Frequency above which a hand no longer follows a motion but feels a buzz; the "above 20 Hz" of all
/// reports.
inline constexpr double kBuzzAbove_hz = 20.0;

/// Value of a figure that could not be measured: NaN.
inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// Contacts of the tool in a tick, and whether the hand felt them.
struct Contact {
  /// The burr presses on bone with 0.02 N or more.
  bool burr = false;
  /// The hand feels a torque of 0.2 N mm or more, twice an encoder step, without the cutting torque. It comes
  /// from the shaft: forces on the burr's ball have no lever arm about its centre.
  bool shaft = false;
  /// The burr presses on bone, or the hand feels a force of 0.02 N or more.
  bool force = false;
  /// The hand feels a torque of 0.2 N mm or more.
  bool torque = false;

  bool any() const { return force || torque; }
};
/// Returns the contacts of a tick.
Contact contact_of(const TickRecord& record);

/// Fractions of a recording's ticks with contact (RunMetrics::contact).
struct ContactShares {
  double any = 0;
  double burr = 0;
  double shaft = 0;
  double force = 0;
  double torque = 0;
  /// Time from the first tick to the last one in contact, if the recording continues for a second or more
  /// after it; 0 if there was no contact at all. NaN if contact was not lost.
  double lost_after_s = kNotMeasured;
  /// Contact was lost while the spindle turned: in this recording or, if it has no contact, before it began.
  bool lost_while_milling = false;

  bool is_lost() const { return !std::isnan(lost_after_s); }
};

/// Returns whether a fraction of contact suffices to measure what is felt: a tenth of the ticks.
inline bool is_enough_contact(double share) {
  return share >= 0.1;
}

/// Returns why a felt quantity could not be measured: "never touched", "lost while milling", "lost while
/// milling, after 3.2 s", "lost contact after 3.2 s", "touched for 4 % of the time", "the shaft touched for 4
/// % of the time", "felt a torque for 4 % of the time" or "felt a force for 4 % of the time".
std::string contact_words(const ContactShares& contact);
/// Summarizes these reasons over the hands in which it could not be measured, out of `hands`, with the number
/// of hands for each reason and the median of their times: "lost while milling in 2 of 8 hands; felt a force
/// for less than 1 % of the time in 6 of 8 hands". Empty if `unmeasured` is empty.
std::string contact_words(std::span<const ContactShares> unmeasured, std::size_t hands);

/// Figures of a vector over time: force (N) or torque (N mm).
struct VectorMetrics {
  /// Mean and largest magnitude over all ticks.
  double mean = 0;
  double max = 0;
  /// Rms magnitude of its part above 20 Hz (signals.h).
  double hp_rms = 0;
  /// Largest magnitude of the difference between two successive ticks.
  double step_max = 0;
  /// `hp_rms` divided by the mean; 0 if the mean is zero.
  double hp_share = 0;
};
/// VectorMetrics of a vector that was not felt long enough to be measured.
inline constexpr VectorMetrics kNotFelt{kNotMeasured, kNotMeasured, kNotMeasured, kNotMeasured, kNotMeasured};
/// Returns the figures over the ticks that are `counted` (empty: all); a step counts if either of its two
/// ticks does. Zeros if there are none.
VectorMetrics vector_metrics(std::span<const Vec3> samples, double rate_hz,
                             const std::vector<bool>& counted = {});

/// Deviation of unit directions from their mean (the direction of their sum), degrees: rms angle and largest
/// angle.
struct DirectionMetrics {
  double spread_deg = 0;
  double excursion_deg = 0;
};
/// Returns the deviations of unit directions; zeros if there are none.
DirectionMetrics direction_metrics(std::span<const Vec3> directions);

/// Rotation of the shaft within 50 ms, degrees: the largest, and the one around the largest torque step.
struct ShaftTurns {
  double max_deg = 0;
  double at_torque_step_deg = 0;
};

/// All figures of one recording (metric_table.h says where each is shown).
struct RunMetrics {
  double steps = 0;
  /// Only ticks this long after the recording's first tick, or later, are counted.
  double counted_from_s = 0;
  /// Wall-clock time of the algorithm's step alone (`compute_us`).
  Distribution step_us;
  /// Time of the whole tick (TickRecord::busy_us).
  Distribution tick_us;
  /// SustainedRate of whole ticks (TickRecord::busy_us), for the recording's tick period.
  double rate_hz = 0;
  ContactShares contact;
  /// Force and torque while in contact; NaN if the hand did not feel the force, or the torque, long enough.
  VectorMetrics force_N;
  VectorMetrics torque_Nmm;
  /// Directions of the simulated tool's shaft while in contact; NaN if the shaft was not in contact long
  /// enough.
  DirectionMetrics shaft;
  /// Spread of those directions relative to the device's handle: what the algorithm adds, without the tilt
  /// that the hand commands.
  double shaft_from_handle_deg = 0;
  ShaftTurns turns;
  /// Correlation of the torque above 20 Hz with the force above 20 Hz within 10 ms of it
  /// (multiple_correlation in signals.h), while the shaft touches; NaN if it touched too briefly.
  double torque_follows_force = 0;
  /// Mean number of sample points in contact, over the ticks in contact; like `turns`, NaN if these ticks are
  /// too few.
  double contacts_mean = 0;
  /// Bone removed by milling after the first tick, and the part of it that undoing a cut restored.
  double removed_mm3 = 0;
  double put_back_mm3 = 0;
  /// Bone removed per second during which the spindle turned and the burr pressed on bone, mm^3/s; NaN if it
  /// never did. Allows comparing runs of different length.
  double removal_mm3_per_s = kNotMeasured;
  /// Length of the path of the burr's centre, sampled every 0.02 s: from tick to tick, tremor would add up to
  /// a long path.
  double path_mm = 0;
  /// Largest distance of the burr from its mean position, from means over 0.1 s, so that buzzing in place
  /// does not count.
  double burr_excursion_mm = 0;
};

/// Returns the figures of the ticks from `first` on. Throws InputError, naming the recording, if there are
/// fewer than two, their time does not increase, a number is not finite, or the tick period is too long to
/// resolve 20 Hz.
RunMetrics run_metrics(const Recording& recording, std::size_t first);
/// Returns the figures of all ticks.
inline RunMetrics run_metrics(const Recording& recording) {
  return run_metrics(recording, 0);
}

/// Flag of a field of RunMetrics: smaller is better (unrest in the hand, and time).
inline constexpr unsigned kLowerIsBetter = 1;
/// Flag of a field of RunMetrics: measured by the machine's clock, so that it differs between runs.
inline constexpr unsigned kMachineDependent = 2;

/// Returns every figure of a run: the columns of summary.csv, in order. A value is NaN if it could not be
/// measured.
template <>
const std::vector<Field<RunMetrics>>& fields_of<RunMetrics>();

/// Returns the figure of this column. Throws std::invalid_argument if there is none.
const Field<RunMetrics>& metric(std::string_view column);

/// A run: its algorithm, hand and figures.
struct MeasuredRun {
  AlgorithmId algorithm;
  std::string phase;
  RunMetrics metrics;
  /// Null if no recording was kept.
  const Recording* recording = nullptr;
  /// Parts of its plan that it did not complete (kNotReachedKey); empty if it completed all.
  std::string not_reached = {};
  std::uint64_t seed = 0;
  /// Stiffness and damping of the simulated hand; 0 if a person held the tool.
  double hand_stiffness_N_per_m = 0;
  double hand_damping_Ns_per_m = 0;
  /// Firmness of that hand's grip: 1 for the hand itself, else for an extra trial (TrialPlan::grip).
  double grip = 1;
  /// 0 for that hand's own tremor, else the number of another one (TrialPlan::other_tremor).
  double other_tremor = 0;

  /// Returns whether this is the hand itself rather than an extra trial.
  bool is_study_hand() const { return grip == 1 && other_tremor == 0; }
};

/// Returns the numeric fields of a run's hand: the columns of study.csv after the seed.
template <>
const std::vector<Field<MeasuredRun>>& fields_of<MeasuredRun>();

}  // namespace osteomill
