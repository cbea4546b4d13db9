#pragma once

#include "osteomill/base/pose.h"
#include "osteomill/session/space_mouse.h"
#include "osteomill/visual/camera.h"

namespace osteomill::app {

/// The input of mouse, keyboard and SpaceMouse to the tool in one picture.
struct ToolInput {
  /// Pixels to the right and down: moves, or with `turning` turns.
  Eigen::Vector2d moved_px = Eigen::Vector2d::Zero();
  bool turning = false;
  /// Steps away from the viewer.
  double wheel = 0;
  /// Held keys, -1, 0 or 1 each: to the right, up, away from the viewer; with `turning` about the first two.
  Vec3 keys = Vec3::Zero();
  /// A SpaceMouse, which always moves and turns.
  SpaceMouseState space_mouse;
  double passed_s = 0;
  /// True if bone holds the tool back.
  bool touching = false;
};

/// Returns the pose that the hand pulls the tool to: it moves in the view's plane, along the view, and turns
/// about the burr's centre. Never far from where the device is, so that pulling back is felt at once.
Pose moved_target(const Pose& X_W_target, const Pose& X_WD, const Camera& camera, const PixelSize& size,
                  const ToolInput& input);

}  // namespace osteomill::app
