#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "osteomill/study/study.h"

namespace osteomill {

/// Which algorithms did what, on which bone, in how many hands.
std::string what_was_compared(const Study& study, std::string_view scan_name);

/// One sentence ahead of all others where a study has too few hands to show anything; else empty.
std::string too_few_hands(const Study& study);

/// What a comparison shows, for whoever reads nothing else, in five sentences with their numbers: force and
/// torque while milling, the shaft while holding, the paper's findings, and how much bone went. With too few
/// hands the numbers alone: none is called the least.
std::vector<std::string> conclusions(const Study& study);

}  // namespace osteomill
