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

/// A trial of the test of section 8.2, and what its recordings describe (record_trial()).
struct TrialPlan {
  /// The bone as scanned; must outlive the plan.
  const Volume& bone;
  ScanIdentity scan;
  BoneDensities densities;
  MillingEntry entry;
  TrialSettings settings;
  /// Command line that repeats the comparison.
  std::string command_line;
  /// Firmness of the grip relative to the study's hand; already applied to `settings`.
  double grip = 1;
  /// If not 0, number of another tremor in the same hand; `settings` already have its seed.
  int other_tremor = 0;
  /// Stiffness felt on a flat wall to which the algorithm was adjusted (match_stiffness.h); nothing if it has
  /// its own.
  std::optional<double> matched_N_per_mm = std::nullopt;
  /// A sentence on each algorithm that was left out because no setting of it is felt as this; empty for none.
  std::string not_matched = {};
  /// Measurement of the algorithm on bones with a known result; nothing if it was not probed.
  std::optional<Probe> probed = std::nullopt;
  /// Value of kComparisonKey in its recordings; empty for none.
  std::string comparison = {};
  /// Further settings for its recordings: how the scan was read.
  std::vector<RunSetting> scan_settings = {};
};

/// Key of the setting with the tool's entry point, in every recording of this test.
inline constexpr std::string_view kScriptEntryKey = "script.entry";

/// Key of the setting with the direction of entry.
inline constexpr std::string_view kScriptDirectionKey = "script.direction";

/// Key of the setting with the time for which the tool is to be held still, s.
inline constexpr std::string_view kScriptHoldingKey = "script.holding";

/// Key of the setting with TrialPlan::matched_N_per_mm.
inline constexpr std::string_view kMatchedStiffnessKey = "matched.felt_stiffness";

/// Key of the setting with TrialPlan::not_matched.
inline constexpr std::string_view kNotMatchedKey = "matched.left_out";

/// Returns the description of a recording of a phase of section 8.2: that of any session, plus hand, device
/// and script.
RunDescription describe_trial(const TrialPlan& plan, int sample_points, std::string_view phase);

/// Returns which parts of the plan were not completed by the end of this phase: "the hole was shallower
/// than 3 mm; the shaft leant on the bone for less than 3 s". Empty for none.
std::string shortfall_words(const ScriptShortfall& shortfall, const ScriptSettings& script,
                            std::string_view phase);

/// Returns the figures of a phase of section 8.2, measured so that phases can be compared. Of a hold, counts
/// only the planned holding time, without the time that the hand took to settle (from counted_from_s on).
/// Figures of what is felt are NaN if the tool lost contact and did not regain it. Throws as run_metrics.
RunMetrics phase_metrics(const Recording& recording);

/// Minimum fraction of a hold in contact.
inline constexpr double kHeldContact = 0.9;
/// Minimum fraction of a hold with the shaft against the wall.
inline constexpr double kHeldShaft = 0.5;
/// Maximum rotation of the shaft from its mean direction in a hold. In 16 hands (docs/questions.md) it
/// rotated by at most 2.3 degrees or by 4.8 and more.
inline constexpr double kHeldTurn_deg = 3;
/// Maximum distance of the burr from its mean position in a hold. In 16 hands it moved by at most 0.4 mm,
/// even with a buzz, or by 0.8 and more. Buzzing in place still counts as a hold: how calm that is, is what a
/// hold measures.
inline constexpr double kHeldBurr_mm = 0.5;

/// Returns which of these limits a hold of section 8.2 exceeded: "the tool touched for less than 90 % of the
/// holding; the shaft turned by more than 3 degrees". Empty for none, and for milling.
std::string broken_hold_words(const RunMetrics& metrics, std::string_view phase);

/// Returns the run of a phase of section 8.2 with its figures (phase_metrics). Its `not_reached` combines the
/// recording's own and broken_hold_words.
MeasuredRun measured_phase(const Recording& recording);

}  // namespace osteomill
