#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "osteomill/study/run_groups.h"

namespace osteomill {

/// The number of findings that check_findings() returns.
inline constexpr std::size_t kFindings = 9;

/// The verdict on a Finding. `not_settled`: the recordings speak neither for it nor against it;
/// `not_recorded`: runs that it needs are not there; `too_little_contact`: a run that it needs had not enough
/// contact.
enum class Verdict : unsigned char { agrees, does_not_agree, not_settled, not_recorded, too_little_contact };

/// Returns "agrees", "does not agree", "not settled", "not recorded" or "too little contact".
std::string_view name_of(Verdict verdict);
/// Returns whether the recordings sufficed to apply the finding's rule.
inline bool is_tested(Verdict verdict) {
  return verdict <= Verdict::not_settled;
}

/// One thing that the paper says it found, held against the recordings by a rule that is stated
/// (check_findings()).
struct Finding {
  /// In its own words, restored where its text has gaps.
  std::string paper_says;
  std::string rule;
  /// The numbers that the rule was applied to, and which of their runs did not reach all of their plan.
  std::string measured;
  Verdict verdict = Verdict::not_recorded;
};

/// The grips of the same hand for one of the findings, the loosest first: the factors of its stiffness and
/// damping (gripping, hand.h).
inline constexpr std::array<double, 3> kGrips{0.5, 1, 2};

/// Algorithm 2's force while it is held in one grip.
struct GripForce {
  /// Above 20 Hz, rms; not a number if it was not felt for long enough, in several hands by most.
  double hp_rms_N = 0;
  /// The number of hands in which it was felt for long enough, and that of all.
  std::size_t felt = 1;
  std::size_t hands = 1;
};
/// One for each of `kGrips`; empty if only one grip was tried.
using GripForces = std::vector<GripForce>;

/// Returns why a figure of a run, or the median of several runs, is not a number.
using WhyNotMeasured =
    std::function<std::string(const MeasuredRun& run, double (*figure)(const RunMetrics&))>;

/// Returns the nine findings of the paper's section 8, as its text has them. One that needs runs which are
/// not there is `not_recorded`, one that needs a run that had not enough contact `too_little_contact`.
std::vector<Finding> check_findings(
    const RunGroup& group, const GripForces& grips,
    const WhyNotMeasured& why = [](const MeasuredRun& run, auto) {
      return contact_words(run.metrics.contact);
    });

}  // namespace osteomill
