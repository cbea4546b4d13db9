#pragma once

#include <string>
#include <vector>

#include "osteomill/report/run_groups.h"

namespace osteomill {

enum class Verdict : unsigned char { agrees, does_not_agree, not_recorded };

/// "agrees", "does not agree", "not recorded".
std::string_view name_of(Verdict verdict);

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
/// are not there is `not_recorded`.
std::vector<Finding> check_findings(const RunGroup& group);

/// In plain words: who was the steadiest in force, in torque and in shaft direction and by how much,
/// whether the rate holds, and how many of the findings agree.
std::vector<std::string> plain_paragraphs(const RunGroup& group, const std::vector<Finding>& findings);

}  // namespace osteomill
