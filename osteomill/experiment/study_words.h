#pragma once

#include <string>

#include "osteomill/experiment/study.h"

namespace osteomill {

/// What the study found, in two plain sentences: one on the paper's findings, one on what `steady` changes
/// (or, where only one mode was tried, on which algorithm was the steadiest).
std::string study_in_two_sentences(const Study& study);

}  // namespace osteomill
