#pragma once

#include <array>
#include <string>
#include <vector>

#include "osteomill/study/run_groups.h"

namespace osteomill {

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
  /// It rests on compute times, which are the machine's and not the algorithms' alone.
  bool of_the_machine = false;
};

/// The grips of the same hand for one of the findings, the loosest first: the factors of its stiffness and
/// damping (gripping, hand.h).
inline constexpr std::array<double, 3> kGrips{0.5, 1, 2};

/// Algorithm 2's force above 20 Hz (rms, N) while it is held, for each of `kGrips`; empty if only one was
/// tried, not a number if contact was lost.
using GripForces = std::vector<double>;

/// Returns the nine findings of the paper's section 8, as its text has them. One that needs runs which are
/// not there is `not_recorded`, one that needs a run that had not enough contact `too_little_contact`.
std::vector<Finding> check_findings(const RunGroup& group, const GripForces& grips);

}  // namespace osteomill
