#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "osteomill/recording/run_description.h"
#include "osteomill/study/metrics.h"
#include "osteomill/study/milling_trial.h"

namespace osteomill {

/// A trial, and what is said of it in its recordings.
struct TrialPlan {
  /// As scanned; outlives the plan.
  const Volume& bone;
  std::string scan_name;
  BoneDensities densities;
  MillingEntry entry;
  TrialSettings settings;
  /// How the comparison was called, for whoever wants to repeat it.
  std::string command_line;
  /// How many times as firmly the hand grips as it is said to otherwise; its settings are those of the grip.
  double grip = 1;
  /// The algorithm's stiffness was chosen so that a flat wall is felt as this (match_stiffness.h); nothing
  /// where it has its own.
  std::optional<double> matched_N_per_mm = std::nullopt;
  /// What kComparisonKey says in its recordings; empty for nothing.
  std::string comparison = {};
  /// Of the bone as scanned (fingerprint_of), for its recordings to be verified.
  std::uint64_t scan_hash = 0;
};

/// The key of the setting in which every recording of this test says where the tool enters.
inline constexpr std::string_view kScriptEntryKey = "script.entry";

/// The key of the setting in which it says for how long the tool was to be held still, in s.
inline constexpr std::string_view kScriptHoldingKey = "script.holding";

/// The key of the setting in which a recording says TrialPlan::matched_N_per_mm.
inline constexpr std::string_view kMatchedStiffnessKey = "matched.felt_stiffness";

/// All that a recording says of a phase of section 8.2: what any session's says, and hand, device and script.
RunDescription describe_trial(const TrialPlan& plan, int sample_points, std::string_view phase);

/// "the hole stayed shallower than 3 mm; the shaft leant on the bone for less than 3 s": what of the plan was
/// not reached up to the end of this phase. Empty for nothing.
std::string shortfall_words(const ScriptShortfall& shortfall, const ScriptSettings& script,
                            std::string_view phase);

/// The figures of a phase of section 8.2 (run_metrics, which says what it throws), measured so that phases
/// can be compared: of a holding, the time for which it was to be held, without what the hand took longer to
/// come to that (counted_from_s says from when); and nothing that is felt where the tool lost contact and did
/// not find it again.
RunMetrics phase_metrics(const Recording& recording);

}  // namespace osteomill
