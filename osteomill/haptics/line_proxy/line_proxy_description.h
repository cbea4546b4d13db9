#pragma once

#include "osteomill/haptics/algorithm_description.h"

namespace osteomill::line_proxy {

/// Algorithm 1 of the paper (section 4).
AlgorithmDescription description();

}  // namespace osteomill::line_proxy
