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

/// The most that a milling loop should lose of 1000 Hz (paper, section 8.1).
inline constexpr double kMinRate_hz = 950.0;
/// The frequency at which a hand stops following and starts to feel a buzz: "above 20 Hz" in all that is
/// reported.
inline constexpr double kBuzzAbove_hz = 20.0;

/// Stands for a figure that could not be measured: not a number.
inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// The contacts of the tool in a tick, and whether the hand felt them.
struct Contact {
  /// The burr presses on bone with 0.02 N or more.
  bool burr = false;
  /// The hand feels a torque of 0.2 N mm or more, twice a step of the encoder, without what cutting adds. It
  /// comes from the shaft: what presses on the burr's ball has no lever about its centre.
  bool shaft = false;
  /// The burr presses on bone, or the hand feels a force of 0.02 N or more.
  bool force = false;
  /// The hand feels a torque of 0.2 N mm or more.
  bool torque = false;

  bool any() const { return force || torque; }
};
/// Returns the contacts of a tick.
Contact contact_of(const TickRecord& record);

/// The shares of a recording's ticks in which the tool touched (RunMetrics::contact).
struct ContactShares {
  double any = 0;
  double burr = 0;
  double shaft = 0;
  double force = 0;
  double torque = 0;
  /// When contact was lost: the time from the first tick to the last one in contact, if the recording then
  /// goes on for a second or more; 0 if nothing touched at all. Not a number if contact was not lost.
  double lost_after_s = kNotMeasured;
  /// It was lost while the spindle turned: in this recording or, if nothing touched in it, before it began.
  bool lost_while_milling = false;

  bool is_lost() const { return !std::isnan(lost_after_s); }
};

/// Returns whether a share of contact is enough to measure what is felt in it: a tenth of the ticks.
inline bool is_enough_contact(double share) {
  return share >= 0.1;
}

/// Returns why something that is felt could not be measured: "never touched", "lost while milling", "lost
/// while milling, after 3.2 s", "lost contact after 3.2 s", "touched for 4 % of the time", "the shaft touched
/// for 4 % of the time", "felt a torque for 4 % of the time" or "felt a force for 4 % of the time".
std::string contact_words(const ContactShares& contact);
/// Returns the same for the hands in which it could not be measured, of `hands` in all, with the number of
/// hands for each reason and the median of their times: "lost while milling in 2 of 8 hands; felt a force for
/// less than 1 % of the time in 6 of 8 hands". Empty for none.
std::string contact_words(std::span<const ContactShares> unmeasured, std::size_t hands);

/// Figures of a vector over time: force (N) or torque (N mm).
struct VectorMetrics {
  /// Mean and greatest magnitude over all ticks.
  double mean = 0;
  double max = 0;
  /// Root of the mean square magnitude of its part above 20 Hz (signals.h).
  double hp_rms = 0;
  /// The greatest magnitude of the difference between two ticks that follow each other.
  double step_max = 0;
  /// `hp_rms` against the mean; 0 if that is zero.
  double hp_share = 0;
};
/// The figures of a vector that was not felt for long enough to be measured.
inline constexpr VectorMetrics kNotFelt{kNotMeasured, kNotMeasured, kNotMeasured, kNotMeasured, kNotMeasured};
/// Returns the figures over the ticks that are `counted` (empty: all); a step counts if one of its two ticks
/// does. Zeros for none.
VectorMetrics vector_metrics(std::span<const Vec3> samples, double rate_hz,
                             const std::vector<bool>& counted = {});

/// The spread of unit directions about their mean (the direction of their sum), in degrees: the root of the
/// mean square angle, and the greatest angle.
struct DirectionMetrics {
  double spread_deg = 0;
  double excursion_deg = 0;
};
/// Returns the spread of unit directions; zeros if there are none.
DirectionMetrics direction_metrics(std::span<const Vec3> directions);

/// The turn of the shaft within 50 ms, in degrees: the greatest, and that about the greatest step of the
/// torque.
struct ShaftTurns {
  double max_deg = 0;
  double at_torque_step_deg = 0;
};

/// All figures of one recording (metric_table.h says where each is shown).
struct RunMetrics {
  double steps = 0;
  /// Only ticks this long after the recording's first one, and later ones, are counted.
  double counted_from_s = 0;
  /// The time of the algorithm's step alone, by the clock (`compute_us`).
  Distribution step_us;
  /// The time of the tick's whole work (TickRecord::busy_us).
  Distribution tick_us;
  /// SustainedRate over the ticks' whole work (TickRecord::busy_us), for the recording's tick.
  double rate_hz = 0;
  ContactShares contact;
  /// Force and torque while in contact; not a number if the hand did not feel a force, or a torque, for long
  /// enough.
  VectorMetrics force_N;
  VectorMetrics torque_Nmm;
  /// The directions of the simulated tool's shaft while in contact; not a number if the shaft did not touch
  /// for long enough.
  DirectionMetrics shaft;
  /// The spread of those directions as seen from the device's handle, so that the lean which the hand
  /// commands does not count: what the algorithm adds to it.
  double shaft_from_handle_deg = 0;
  ShaftTurns turns;
  /// The share of the torque above 20 Hz that follows the force above 20 Hz of the 10 ms about it
  /// (signals.h), while the shaft touches; not a number if it touched for too short a time.
  double torque_follows_force = 0;
  /// The mean number of sample points that touch, over the ticks in contact; like the turns not a number if
  /// these ticks are too few.
  double contacts_mean = 0;
  /// Bone removed by milling after the first tick, and the part of it that was put back when a cut was taken
  /// back.
  double removed_mm3 = 0;
  double put_back_mm3 = 0;
  /// Bone removed per second for which the spindle turned and the burr pressed on bone, mm^3/s; not a number
  /// if it did not. Runs of different length compare by it.
  double removal_mm3_per_s = kNotMeasured;
  /// The length of the burr's path, by its centre's place every 0.02 s: from tick to tick a trembling hand
  /// goes far without getting anywhere.
  double path_mm = 0;
  /// The burr's greatest distance from its mean place, by the means of every 0.1 s: a burr that buzzes in one
  /// place does not get far.
  double burr_excursion_mm = 0;
};

/// Returns the figures of the ticks from the `first` on. Throws InputError, naming the recording, if these
/// are fewer than two, their time does not increase, a number is not finite, or they are too far apart to say
/// anything about 20 Hz.
RunMetrics run_metrics(const Recording& recording, std::size_t first);
/// Returns the figures of all ticks.
inline RunMetrics run_metrics(const Recording& recording) {
  return run_metrics(recording, 0);
}

/// A flag of the fields of RunMetrics: a smaller one is better (unrest in the hand, and time).
inline constexpr unsigned kLessIsBetter = 1;
/// A flag of the fields of RunMetrics: the machine's clock decides, so that it differs from run to run.
inline constexpr unsigned kOfTheMachine = 2;

/// Returns every figure of a run, the columns of summary.csv in their order. A value is not a number if it
/// could not be measured.
template <>
const std::vector<Field<RunMetrics>>& fields_of<RunMetrics>();

/// Returns the figure of this column. Throws std::invalid_argument if there is none.
const Field<RunMetrics>& metric(std::string_view column);

/// A run: its algorithm, its hand and its figures.
struct MeasuredRun {
  AlgorithmId algorithm;
  std::string phase;
  RunMetrics metrics;
  /// Null if no recording was kept.
  const Recording* recording = nullptr;
  /// The parts of its plan that it did not reach (kNotReachedKey); empty for none.
  std::string not_reached = {};
  std::uint64_t seed = 0;
  /// Stiffness and damping of the simulated hand; 0 if a person held the tool.
  double hand_stiffness_N_per_m = 0;
  double hand_damping_Ns_per_m = 0;
  /// The firmness of that hand's grip: 1 for the hand as it is, else for a trial beside it (TrialPlan::grip).
  double grip = 1;
  /// 0 with that hand's own tremor, else the number of another one (TrialPlan::other_tremor).
  double other_tremor = 0;

  /// Returns whether this is the hand as it is, and no trial beside it.
  bool is_own() const { return grip == 1 && other_tremor == 0; }
};

/// Returns the numbers that a run has of its hand, the columns of study.csv behind the seed.
template <>
const std::vector<Field<MeasuredRun>>& fields_of<MeasuredRun>();

}  // namespace osteomill
