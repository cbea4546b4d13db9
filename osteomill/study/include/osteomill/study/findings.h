#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "osteomill/study/run_groups.h"

namespace osteomill {

/// /// Number of findings that check_findings() returns.
inline constexpr std::size_t kFindings = 9;

/// Verdict on a Finding. `not_settled`: the recordings neither support nor contradict it; `not_recorded`:
/// runs that it needs are missing; `too_little_contact`: a run that it needs has too little contact.
enum class Verdict : unsigned char { agrees, does_not_agree, not_settled, not_recorded, too_little_contact };

/// Returns "agrees", "does not agree", "not settled", "not recorded" or "too little contact".
std::string_view name_of(Verdict verdict);
/// Returns whether the recordings were sufficient to apply the finding's rule.
inline bool is_tested(Verdict verdict) {
  return verdict <= Verdict::not_settled;
}

/// A claim of the paper, tested on the recordings by an explicit rule (check_findings()).
struct Finding {
  /// The paper's own words, restored if its text has gaps.
  std::string paper_says;
  std::string rule;
  /// The numbers that the rule was applied to, and which of their runs did not complete their plan.
  std::string measured;
  Verdict verdict = Verdict::not_recorded;
};

/// Grips of the same hand for the finding on grips, loosest first: factors of its stiffness and
/// damping (gripping, hand.h).
inline constexpr std::array<double, 3> kGrips{0.5, 1, 2};

/// Force of algorithm 2 while holding, in one grip.
struct GripForce {
  /// Rms above 20 Hz; NaN if it was not felt long enough, or not in most of several hands.
  double hp_rms_N = 0;
  /// Number of hands in which it was felt long enough, and of all hands.
  std::size_t felt = 1;
  std::size_t hands = 1;
};
/// One for each of `kGrips`; empty if only one grip was tried.
using GripForces = std::vector<GripForce>;

/// Returns why a figure of a run, or the median of several runs, is NaN.
using WhyNotMeasured =
    std::function<std::string(const MeasuredRun& run, double (*figure)(const RunMetrics&))>;

/// Checks the nine findings of the paper's section 8, in the order of its text. Returns `not_recorded` for
/// one whose runs are missing, `too_little_contact` for one that needs a run with too little contact.
std::vector<Finding> check_findings(
    const RunGroup& group, const GripForces& grips,
    const WhyNotMeasured& why = [](const MeasuredRun& run, auto) {
      return contact_words(run.metrics.contact);
    });

}  // namespace osteomill
