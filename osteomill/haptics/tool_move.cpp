#include "osteomill/haptics/tool_move.h"

#include <algorithm>

namespace osteomill {

ToolMove move_between(const Pose& from, const Pose& to) {
  return {to.position_mm - from.position_mm,
          rotation_vector((to.orientation * from.orientation.conjugate()).normalized())};
}

Pose moved(const Pose& X_WT, const ToolMove& move) {
  const Quat turn = quaternion_from_rotation_vector(move.rotation_rad);
  return {X_WT.position_mm + move.translation_mm, (turn * X_WT.orientation).normalized()};
}

double share_released(const Pose& X_WT_start, const Pose& X_WT_target, const Pose& X_WD, double allowed_mm,
                      double allowed_rad) {
  const ToolMove before = move_between(X_WD, X_WT_start);
  const ToolMove after = move_between(X_WD, X_WT_target);
  const double released_mm = before.translation_mm.norm() - after.translation_mm.norm();
  const double released_rad = before.rotation_rad.norm() - after.rotation_rad.norm();
  double share = 1;
  if (released_mm > allowed_mm) share = allowed_mm / released_mm;
  if (released_rad > allowed_rad) share = std::min(share, allowed_rad / released_rad);
  return share;
}

}  // namespace osteomill
