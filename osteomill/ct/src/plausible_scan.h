#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/work_progress.h"
#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// Throws InputError, naming `subject`, if a grid cannot be a scan of a bone: spacing below 1 um or above 100
/// mm, or a first voxel over 100 m from the scanner's origin. Later computations would overflow or not
/// terminate.
inline void check_plausible(const std::string& subject, const GridGeometry& geometry) {
  constexpr double kMinSpacing_mm = 1e-3, kMaxSpacing_mm = 100, kMaxOrigin_mm = 1e5;
  for (const double spacing_mm : geometry.spacing_mm) {
    if (!(spacing_mm >= kMinSpacing_mm && spacing_mm <= kMaxSpacing_mm)) {
      throw InputError(subject, fmt::format("has voxels {:.6g} mm apart; a bone's are between {} and {} mm",
                                            spacing_mm, kMinSpacing_mm, kMaxSpacing_mm));
    }
  }
  for (const double origin_mm : geometry.origin_mm) {
    if (!(std::abs(origin_mm) <= kMaxOrigin_mm)) {
      throw InputError(subject,
                       fmt::format("starts {:.6g} mm from its origin, farther than any scanner reaches",
                                   std::abs(origin_mm)));
    }
  }
}

/// Throws InputError, naming `subject`, if the densities would need more memory than `max_bytes`.
inline void check_memory(const std::string& subject, std::uint64_t voxels, std::uint64_t max_bytes) {
  const std::uint64_t needed = voxels * sizeof(float);
  if (needed > max_bytes) {
    throw InputError(subject,
                     fmt::format("needs {:.3g} GB for its voxels, over the limit of {:.3g} GB (--max-memory)",
                                 static_cast<double>(needed) * 1e-9, static_cast<double>(max_bytes) * 1e-9));
  }
}

/// Returns the number of voxels without density (NaN). Throws InputError, naming `subject`, if that is all of
/// them, or if a density is infinite or beyond what any scanner writes, because gradients would overflow.
inline std::size_t check_densities(const std::string& subject, const std::vector<float>& densities) {
  constexpr std::size_t kAtOnce = 1 << 22;
  constexpr float kMost = 1e10f;
  std::ptrdiff_t none = 0, beyond = 0;
  for (std::size_t first = 0; first < densities.size(); first += kAtOnce) {
    const std::size_t last = std::min(first + kAtOnce, densities.size());
    const auto begin = densities.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = densities.begin() + static_cast<std::ptrdiff_t>(last);
    none += std::count_if(begin, end, [](float v) { return std::isnan(v); });
    beyond += std::count_if(begin, end, [](float v) { return std::abs(v) > kMost; });
    WorkProgress::done(last, densities.size());
  }
  if (beyond > 0) {
    throw InputError(subject, fmt::format("{} voxels have no valid density: infinite or beyond {:g}", beyond,
                                          static_cast<double>(kMost)));
  }
  if (static_cast<std::size_t>(none) == densities.size())
    throw InputError(subject, "has no density at all: every voxel is NaN or padding");
  return static_cast<std::size_t>(none);
}

}  // namespace osteomill
