#pragma once

#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// Trilinear density at a point of W. Beyond the border voxels it falls to the outside density within one
/// voxel. Safe in the haptic tick.
double density_at(const DensityGrid& grid, const Vec3& point_W);

/// Trilinear density at continuous voxel coordinates.
double density_at_voxel(const DensityGrid& grid, const Vec3& voxel);

/// How the differences of a gradient are taken.
enum class GradientKernel : unsigned char {
  /// Central differences of neighbouring voxels, interpolated trilinearly.
  central,
  /// Each difference averaged over its 3 x 3 neighbours with weights 3, 10, 3 (Scharr), which turns less with
  /// the
  /// grid: about a tenth of the error in direction on an edge two voxels wide.
  smoothed,
};

/// Gradient of the density in W (density per mm). Safe in the haptic tick.
Vec3 density_gradient(const DensityGrid& grid, const Vec3& point_W, GradientKernel kernel);

}  // namespace osteomill
