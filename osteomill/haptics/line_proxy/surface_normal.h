#pragma once

#include <optional>

#include "osteomill/volume/sampling.h"
#include "osteomill/volume/volume.h"

namespace osteomill::line_proxy {

/// How the normal of the isosurface is found.
struct NormalRule {
  GradientKernel kernel = GradientKernel::smoothed;
  /// 0 takes the gradient at the point alone; otherwise the sum of eight, at the corners of a cube this far
  /// (in voxels) from it, which quarters the turning of the normal with the grid.
  double spread_voxels = 1.25;
};

/// The unit vector out of the bone at a point, or nothing where the density is flat. Safe in the haptic tick.
std::optional<Vec3> surface_normal(const Volume& volume, const Vec3& point_W, const NormalRule& rule);

}  // namespace osteomill::line_proxy
