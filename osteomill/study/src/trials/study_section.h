#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/study/figure.h"
#include "osteomill/study/page.h"
#include "osteomill/study/probe.h"
#include "osteomill/study/study.h"

#include "trials/statistics.h"

namespace osteomill {

std::vector<std::string> labels_of(const std::vector<AlgorithmId>& algorithms);

/// "this", "this and that", "this, that and those".
std::string in_words(const std::vector<std::string>& all);

/// Draws a dot for every seed, by algorithm, with a bar at their median: a panel for each key metric that is
/// not zero throughout, at most twelve.
Figure draw_study_figure(const Study& study, std::string_view phase, const std::filesystem::path& folder);

/// A comparison of two algorithms by one figure, paired hand by hand.
struct PairedComparison {
  AlgorithmId first;
  AlgorithmId second;
  /// Decided by the sums of signed ranks; false if neither is.
  bool second_is_greater = false;
  /// The size of the median difference, and that against the lesser of the two medians (infinite if that is
  /// 0).
  double difference = 0;
  double share = 0;
  /// Whether a hand notices it (least_noticeable).
  bool is_noticeable = true;
  /// Whether another tremor in the same hand gives as much.
  bool is_less_than_tremor = false;
  /// Wilcoxon's signed-rank test, exact, two-sided, after Holm's correction over all comparisons made
  /// together.
  double p = 1;
  bool is_settled() const { return p <= kSignificance; }
};

/// Compares every pair of the algorithms that were tried, by the hands in which both could be measured.
std::vector<PairedComparison> compare_algorithms(const Study& study, std::string_view phase,
                                                 const Field<RunMetrics>& figure);

/// Returns a sentence on which algorithms did what, on which bone, in how many hands.
std::string what_was_compared(const Study& study, std::string_view scan_name);

/// Returns how the first table of `conclusions` is to be read.
std::string about_the_table(const Study& study);

/// Returns a warning, to stand ahead of all else, that a study has too few hands to show anything; empty
/// if it has enough.
std::string too_few_hands(const Study& study);

/// Returns the tables that show what a comparison found, for readers of nothing else: a row for each
/// algorithm with what one chooses by, each figure with its rank if the hands settle it; and how many of the
/// paper's findings hold. `probes` has the algorithms that were probed, by their names.
std::vector<Table> conclusions(const Study& study, const std::map<std::string, Probe>& probes = {});

/// Returns which algorithm to take for what, with the reason, by the ranks that the hands settle among those
/// that did all of the test in most hands, and what they do not settle; empty if the hands are too few, or
/// for one algorithm alone.
std::string which_to_take(const Study& study);

/// Returns the report's section on a study: medians with their intervals, and which differences between
/// algorithms are significant.
Section study_section(const Study& study, const std::vector<CaptionedFigure>& figures);

/// Returns the report's section on holdings of all algorithms in one hole, which `study` has alone.
Section one_hole_section(const Study& study);

/// Returns the report's section on what the paper says it found, each held against the study; empty if the
/// study has nothing that a finding needs.
Section findings_section(const Study& study);

}  // namespace osteomill
