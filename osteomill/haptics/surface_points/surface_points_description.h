#pragma once

#include "osteomill/haptics/algorithm_description.h"

namespace osteomill::surface_points {

/// Algorithm 2 of the paper (section 5).
AlgorithmDescription description();

}  // namespace osteomill::surface_points
