#pragma once

#include "osteomill/base/pose.h"

namespace osteomill {

/// Transform from the frame G of a grid of bone points to T: a point of G is `offset_mm + turn * p_G` in T.
/// `turn` includes a reflection if the grid is left-handed.
struct ToolFromGrid {
  Mat3 turn;
  Vec3 offset_mm;

  /// Takes any type that gives the pose of G in W: points are at `origin_W() + direction() * p_G`.
  template <typename Points>
  ToolFromGrid(const Points& points, const Pose& X_WT) {
    const Mat3 R_TW = X_WT.orientation.conjugate().toRotationMatrix();
    turn = R_TW * points.direction();
    offset_mm = R_TW * (points.origin_W() - X_WT.position_mm);
  }
  Vec3 operator*(const Vec3& point_G) const { return offset_mm + turn * point_G; }
};

}  // namespace osteomill
