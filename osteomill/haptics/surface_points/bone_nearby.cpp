#include "osteomill/haptics/surface_points/bone_nearby.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace osteomill::surface_points {

bool bone_near_disc(const Volume& volume, const Vec3& centre_W, const Vec3& axis_W, double radius_mm) {
  const GridGeometry& geometry = volume.geometry();
  const Vec3 axis = geometry.direction.transpose() * axis_W;
  const Vec3 centre = geometry.voxel_from_world(centre_W);
  std::array<int, 3> first;
  std::array<int, 3> last;
  for (std::size_t n = 0; n < 3; ++n) {
    const auto i = static_cast<Eigen::Index>(n);
    const double extent =
        radius_mm * std::sqrt(std::max(0.0, 1 - axis[i] * axis[i])) / geometry.spacing_mm[i] + 1e-6;
    // Density falls off within a voxel beyond the border, so a disc there asks the border's bricks.
    const double max = geometry.dims[n] - 1;
    const auto brick = [&](double voxel) {
      return static_cast<int>(std::clamp(voxel, 0.0, max)) / BlockRanges::kBrickVoxels;
    };
    first[n] = brick(std::floor(centre[i] - extent));
    last[n] = brick(std::floor(centre[i] + extent));
  }
  for (int k = first[2]; k <= last[2]; ++k) {
    for (int j = first[1]; j <= last[1]; ++j) {
      for (int i = first[0]; i <= last[0]; ++i) {
        if (static_cast<double>(volume.bricks().at(i, j, k).max) > volume.isovalue()) return true;
      }
    }
  }
  return false;
}

}  // namespace osteomill::surface_points
