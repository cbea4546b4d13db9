#pragma once

#include <string>
#include <vector>

#include "osteomill/report/run_groups.h"

namespace osteomill {

enum class Verdict : unsigned char { agrees, does_not_agree, not_recorded, lost_contact };

/// "agrees", "does not agree", "not recorded", "lost contact".
std::string_view name_of(Verdict verdict);
inline bool is_tested(Verdict verdict) {
  return verdict == Verdict::agrees || verdict == Verdict::does_not_agree;
}

/// One thing that the paper found, held against the recordings by a rule that is stated.
struct Finding {
  std::string paper_says;
  std::string rule;
  /// The numbers that the rule was applied to.
  std::string measured;
  Verdict verdict = Verdict::not_recorded;
  /// It rests on compute times, which are the machine's and not the algorithms' alone.
  bool of_the_machine = false;
};

/// The paper's findings (section 8.2) on rate, force, torque and shaft direction. One that needs runs which
/// are not there is `not_recorded`, one that needs a run that had not enough contact `lost_contact`.
std::vector<Finding> check_findings(const RunGroup& group);

}  // namespace osteomill
