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
  /// The verdict of the hands: agreement, or its absence, if it is the same in enough more than half for the
  /// sign test to be significant, which takes five hands; else it is not settled. If it could be tested in
  /// no more than half, it is the verdict of the medians.
  Verdict verdict = Verdict::not_recorded;
  /// In how many seeds the rule holds, and to how many it can be applied.
  std::size_t agreeing = 0;
  std::size_t tested = 0;
  /// The chance of this number, or more, by tossing a coin: the sign test that the rule holds in more than
  /// half of all hands. 1 if it was not tested.
  double p = 1;
};

/// Holds the paper's findings against a study.
std::vector<StudyFinding> check_study_findings(const Study& study);

}  // namespace osteomill
