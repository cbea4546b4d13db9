#include "osteomill/operator/free_pose.h"

#include <array>
#include <cmath>

#include "osteomill/operator/entry_places.h"

namespace osteomill {

namespace {

constexpr double kBefore_mm = 3.0;
// Further than this from a body's bone there is none.
constexpr double kFarthest_mm = 1e4;
// What algorithms feel ahead of the bone ends within it.
constexpr double kRoom_mm = 1.0;

struct Tilt {
  double aside_rad;
  // From the right, against the clock as it is seen.
  double towards_rad;
};
// Upwards to the right as a right hand holds it, then elsewhere, at last straight to the viewer.
constexpr std::array kTilts{Tilt{0.9, 1.0}, Tilt{0.9, 2.1}, Tilt{0.9, 0.0}, Tilt{0.9, 3.1}, Tilt{0.9, 4.2},
                            Tilt{0.9, 5.2}, Tilt{0.4, 1.0}, Tilt{0.4, 2.1}, Tilt{0.4, 4.2}, Tilt{0.0, 0.0}};

}  // namespace

Pose free_pose_before(const Volume& volume, const MillingTool& tool, const Vec3& point_W,
                      const Vec3& towards_viewer_W, const Vec3& up_W) {
  const Vec3 right_W = up_W.cross(towards_viewer_W);
  const double room_mm = std::max(kRoom_mm, 2 * volume.geometry().spacing_mm.maxCoeff());
  MillingTool with_room = tool;
  with_room.burr_radius_mm += room_mm;
  with_room.shaft_radius_mm += room_mm;
  Pose X_WT;
  for (double before_mm = std::max(kBefore_mm, 1.5 * room_mm); before_mm < kFarthest_mm; before_mm *= 1.5) {
    X_WT.position_mm = point_W + (tool.burr_radius_mm + before_mm) * towards_viewer_W;
    for (const Tilt& tilt : kTilts) {
      const Vec3 aside_W = std::cos(tilt.towards_rad) * right_W + std::sin(tilt.towards_rad) * up_W;
      const Vec3 shaft_W = std::cos(tilt.aside_rad) * towards_viewer_W + std::sin(tilt.aside_rad) * aside_W;
      X_WT.orientation = smallest_rotation(Vec3::UnitZ(), shaft_W);
      if (tool_is_free(volume, with_room, X_WT)) return X_WT;
    }
  }
  return X_WT;
}

}  // namespace osteomill
