#pragma once

#include "osteomill/haptics/point_shell/point_shell.h"

namespace osteomill::point_shell {

/// The grid's frame G seen from the tool: a point of G lies at `offset_mm + turn * p_G` in T. The turn
/// mirrors where the grid is left-handed.
struct ToolFromGrid {
  Mat3 turn;
  Vec3 offset_mm;

  ToolFromGrid(const PointShell& shell, const Pose& X_WT) {
    const Mat3 R_TW = X_WT.orientation.toRotationMatrix().transpose();
    turn = R_TW * shell.direction();
    offset_mm = R_TW * (shell.origin_W() - X_WT.position_mm);
  }
  Vec3 operator*(const Vec3& point_G) const { return offset_mm + turn * point_G; }
};

inline Vec3 position_of(const ShellPoint& point) {
  return {static_cast<double>(point.x_mm), static_cast<double>(point.y_mm), static_cast<double>(point.z_mm)};
}
inline Vec3 normal_of(const ShellPoint& point) {
  return {static_cast<double>(point.normal_x), static_cast<double>(point.normal_y),
          static_cast<double>(point.normal_z)};
}

}  // namespace osteomill::point_shell
