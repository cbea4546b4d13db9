#pragma once

#include <algorithm>

#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// Returns the largest distance, mm, between the burr's surface and bone that counts as pressed on: the gap
/// that a proxy or skin keeps (0.12 mm), or half a voxel, the surface error of a coarse scan, if that is
/// larger.
inline double pressing_reach_mm(const GridGeometry& geometry) {
  constexpr double kMinReach_mm = 0.12;
  return std::max(0.5 * geometry.spacing_mm.maxCoeff(), kMinReach_mm);
}

}  // namespace osteomill
