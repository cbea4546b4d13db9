#pragma once

#include <algorithm>

#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// Returns how far from the burr's surface the bone that it presses on may lie, in mm: as far as a proxy or a
/// skin keeps the burr away, and at least half a voxel, by which the surface of a coarse scan may be wrong.
inline double pressing_reach_mm(const GridGeometry& geometry) {
  constexpr double kMinReach_mm = 0.12;
  return std::max(0.5 * geometry.spacing_mm.maxCoeff(), kMinReach_mm);
}

}  // namespace osteomill
