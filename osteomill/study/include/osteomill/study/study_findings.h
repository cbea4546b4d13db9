#pragma once

#include <cstddef>
#include <vector>

#include "osteomill/study/findings.h"
#include "osteomill/study/study.h"

namespace osteomill {

/// One of the paper's findings, over all seeds of a study.
struct StudyFinding {
  /// The rule applied to the medians over the seeds.
  Finding of_medians;
  /// Verdict over the hands: that of the medians if these could not be tested; else `too_little_contact` if
  /// at most half of the hands could be; else `agrees` or `does_not_agree` if more than half of the hands do
  /// so and the sign test is significant, which takes five hands; else `not_settled`.
  Verdict verdict = Verdict::not_recorded;
  /// Number of seeds in which the rule holds, and to which it can be applied.
  std::size_t agreeing = 0;
  std::size_t tested = 0;
  /// Probability of this number or more in coin tosses: sign test of the rule holding in more than half of
  /// all hands. 1 if it was not tested.
  double p = 1;
};

/// Tests the paper's findings on a study.
std::vector<StudyFinding> check_study_findings(const Study& study);

}  // namespace osteomill
