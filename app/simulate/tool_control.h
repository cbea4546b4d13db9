#pragma once

#include "osteomill/base/pose.h"
#include "osteomill/session/space_mouse.h"
#include "osteomill/visual/camera.h"

namespace osteomill::app {

/// Input of mouse, keyboard and SpaceMouse to the tool in one frame.
struct ToolInput {
  /// Pointer motion to the right and down, pixels: moves the tool, or turns it if `turning`.
  Eigen::Vector2d moved_px = Eigen::Vector2d::Zero();
  bool turning = false;
  /// Wheel steps; positive moves away from the viewer.
  double wheel = 0;
  /// Held keys, -1, 0 or 1 each: to the right, up, away from the viewer; if `turning`, rotation about the
  /// first two.
  Vec3 keys = Vec3::Zero();
  /// A SpaceMouse always moves and turns.
  SpaceMouseState space_mouse;
  double passed_s = 0;
  /// True if bone holds the tool back.
  bool touching = false;
};

/// Returns the target pose of the hand: moved in the view plane and along the view, and turned about the
/// burr's centre. Limited to a distance from the device's pose, so that pulling back takes effect at once.
Pose moved_target(const Pose& X_W_target, const Pose& X_WD, const Camera& camera, const PixelSize& size,
                  const ToolInput& input);

}  // namespace osteomill::app
