#pragma once

#include "osteomill/haptics/algorithm_description.h"

namespace osteomill::barrier_shell {

/// Algorithm 4, not the paper's; it has one mode.
AlgorithmDescription description();

}  // namespace osteomill::barrier_shell
