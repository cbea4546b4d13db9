#include "osteomill/haptics/burr_presses.h"

#include "osteomill/volume/isosurface.h"

namespace osteomill {

Vec3 cube_direction(int n) {
  const int cell = n < kCubeDirections / 2 ? n : n + 1;  // the middle one is no direction
  return Vec3(cell % 3 - 1, cell / 3 % 3 - 1, cell / 9 - 1).normalized();
}

bool burr_presses(const Volume& volume, const MillingTool& tool, const Pose& X_WT, const Vec3& force_W_N) {
  // In the others the ball, moved on, hardly goes where it was not.
  constexpr double kAhead = 0.25;
  const Vec3 ahead = force_W_N.normalized();
  const Vec3 moved_W = X_WT.position_mm + volume.geometry().spacing_mm.maxCoeff() * ahead;
  const auto meets = [&](const Vec3& direction) {
    return is_bone_at(volume, moved_W + tool.burr_radius_mm * direction);
  };
  if (meets(ahead)) return true;
  for (int n = 0; n < kCubeDirections; ++n) {
    const Vec3 direction = X_WT.orientation * cube_direction(n);
    if (direction.dot(ahead) > kAhead && meets(direction)) return true;
  }
  return false;
}

}  // namespace osteomill
