#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/recording/run_description.h"
#include "osteomill/study/metrics.h"
#include "osteomill/study/milling_trial.h"
#include "osteomill/study/probe.h"

namespace osteomill {

/// A trial of the test of section 8.2, and what its recordings say about it (record_trial()).
struct TrialPlan {
  /// The bone as scanned; outlives the plan.
  const Volume& bone;
  ScanIdentity scan;
  BoneDensities densities;
  MillingEntry entry;
  TrialSettings settings;
  /// The command line of the comparison, by which it can be repeated.
  std::string command_line;
  /// The factor by which the hand grips more firmly than the study's hand; `settings` already have the hand
  /// with this grip.
  double grip = 1;
  /// Beyond 0 the number of another tremor in the same hand; `settings` already have its seed.
  int other_tremor = 0;
  /// The algorithm's stiffness was chosen so that a flat wall is felt as this (match_stiffness.h); nothing if
  /// it has its own.
  std::optional<double> matched_N_per_mm = std::nullopt;
  /// One sentence on each algorithm that was left out, because no stiffness of it is felt as this; empty for
  /// none.
  std::string not_matched = {};
  /// The algorithm with these settings, felt where the right answer is known; nothing if it was not probed.
  std::optional<Probe> probed = std::nullopt;
  /// The value of kComparisonKey in its recordings; empty for none.
  std::string comparison = {};
  /// Further settings that its recordings carry: how the scan was read.
  std::vector<RunSetting> scan_settings = {};
};

/// The key of the setting in which every recording of this test says where the tool enters.
inline constexpr std::string_view kScriptEntryKey = "script.entry";

/// The key of the setting in which it says in which direction.
inline constexpr std::string_view kScriptDirectionKey = "script.direction";

/// The key of the setting in which it says for how long the tool was to be held still, in s.
inline constexpr std::string_view kScriptHoldingKey = "script.holding";

/// The key of the setting in which a recording says TrialPlan::matched_N_per_mm.
inline constexpr std::string_view kMatchedStiffnessKey = "matched.felt_stiffness";

/// The key of the setting in which it says TrialPlan::not_matched.
inline constexpr std::string_view kNotMatchedKey = "matched.left_out";

/// Returns all that a recording says about a phase of section 8.2: what any session's recording says, and
/// hand, device and script.
RunDescription describe_trial(const TrialPlan& plan, int sample_points, std::string_view phase);

/// Returns which parts of the plan were not reached up to the end of this phase: "the hole stayed shallower
/// than 3 mm; the shaft leant on the bone for less than 3 s". Empty for none.
std::string shortfall_words(const ScriptShortfall& shortfall, const ScriptSettings& script,
                            std::string_view phase);

/// Returns the figures of a phase of section 8.2 (run_metrics, which says what it throws), measured so that
/// phases can be compared. A holding counts only for the time for which it was to be held, without the time
/// that the hand took to come to it (from counted_from_s on). Figures of what is felt are missing if the tool
/// lost contact and did not find it again.
RunMetrics phase_metrics(const Recording& recording);

/// The least share of the time of a hold in contact.
inline constexpr double kHeldContact = 0.9;
/// The least share of the time of a hold with the shaft against the wall.
inline constexpr double kHeldShaft = 0.5;
/// The furthest that the shaft may turn from its mean direction in a hold. In 16 hands (docs/questions.md) it
/// turned by at most 2.3 degrees or by 4.8 and more.
inline constexpr double kHeldTurn_deg = 3;
/// The furthest that the burr may go from its mean place in a hold. In 16 hands it went by at most 0.4 mm,
/// with a buzz too, or by 0.8 and more. A buzz in one place is held: how calm that is, is what a holding
/// measures.
inline constexpr double kHeldBurr_mm = 0.5;

/// Returns which of these a holding of section 8.2 broke: "the tool touched for less than 90 % of the
/// holding; the shaft turned by more than 3 degrees". Empty for none, and for a milling.
std::string broken_hold_words(const RunMetrics& metrics, std::string_view phase);

/// Returns the run of a phase of section 8.2 with its figures (phase_metrics). What it did not reach is what
/// its recording names and broken_hold_words.
MeasuredRun measured_phase(const Recording& recording);

}  // namespace osteomill
