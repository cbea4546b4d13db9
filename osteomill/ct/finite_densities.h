#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "osteomill/files/input_error.h"
#include "osteomill/numbers/work_progress.h"

namespace osteomill {

/// Throws InputError naming `subject` where a density is not a finite number: nothing sensible can be milled
/// there.
inline void check_finite(const std::string& subject, const std::vector<float>& densities) {
  constexpr std::size_t kAtOnce = 1 << 22;
  std::ptrdiff_t count = 0;
  for (std::size_t first = 0; first < densities.size(); first += kAtOnce) {
    const std::size_t last = std::min(first + kAtOnce, densities.size());
    count += std::count_if(densities.begin() + static_cast<std::ptrdiff_t>(first),
                           densities.begin() + static_cast<std::ptrdiff_t>(last),
                           [](float v) { return !std::isfinite(v); });
    WorkProgress::done(last, densities.size());
  }
  if (count > 0) {
    throw InputError(subject, std::to_string(count) + " voxels hold no finite number (NaN or infinity)");
  }
}

}  // namespace osteomill
