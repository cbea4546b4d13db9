#include "osteomill/haptics/tool_move.h"

#include <algorithm>

namespace osteomill {

namespace {

// What a tick may release by its length; a longer one (a machine that stood still) counts as this long.
constexpr double kMaxTick_s = 5e-3;
// In which a stretch that nothing holds any more falls to a third, if not sooner.
constexpr double kReleaseTime_s = 0.1;
constexpr double kRelease_mm_s = 15;
constexpr double kRelease_rad_s = 0.05;
// Of the turn by which a move of the device would be made at the tool's far end.
constexpr double kTurnByMove = 0.25;

}  // namespace

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

Pose released(const Pose& X_WT_start, const Pose& X_WT_target, const Pose& X_WD_before, const Pose& X_WD,
              double length_mm, double dt_s) {
  const double tick_s = std::clamp(dt_s, 0.0, kMaxTick_s);
  const ToolMove device = move_between(X_WD_before, X_WD);
  const double moved_mm = device.translation_mm.norm();
  const double turned_rad = device.rotation_rad.norm();
  const ToolMove stretch = move_between(X_WD, X_WT_start);
  const double fading = tick_s / kReleaseTime_s;
  // A turn of the device may move the tool by what it moves the tool's far end, and a move turn it by a part
  // of that: held up in its turn alone, a tool that leaves the bone would be dragged behind.
  const double share = share_released(
      X_WT_start, X_WT_target, X_WD,
      moved_mm + turned_rad * length_mm + fading * stretch.translation_mm.norm() + kRelease_mm_s * tick_s,
      turned_rad + kTurnByMove * moved_mm / length_mm + fading * stretch.rotation_rad.norm() +
          kRelease_rad_s * tick_s);
  if (share >= 1) return X_WT_target;
  const ToolMove whole = move_between(X_WT_start, X_WT_target);
  return moved(X_WT_start, {share * whole.translation_mm, share * whole.rotation_rad});
}

}  // namespace osteomill
