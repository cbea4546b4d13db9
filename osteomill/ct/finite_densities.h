#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "osteomill/files/input_error.h"

namespace osteomill {

/// Throws InputError naming `subject` where a density is not a finite number: nothing sensible can be milled
/// there.
inline void check_finite(const std::string& subject, const std::vector<float>& densities) {
  const auto count =
      std::count_if(densities.begin(), densities.end(), [](float v) { return !std::isfinite(v); });
  if (count > 0) {
    throw InputError(subject, std::to_string(count) + " voxels hold no finite number (NaN or infinity)");
  }
}

}  // namespace osteomill
