#pragma once

#include "osteomill/haptics/algorithm_description.h"

namespace osteomill::point_shell {

/// Algorithm 3 of the paper (section 6).
AlgorithmDescription description();

}  // namespace osteomill::point_shell
