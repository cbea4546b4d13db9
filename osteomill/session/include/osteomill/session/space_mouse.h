#pragma once

#include "osteomill/base/pose.h"

namespace osteomill {

/// Deflection of a SpaceMouse, -1 to 1 along and about each axis of the viewer: right, up, towards the
/// viewer.
struct SpaceMouseState {
  Vec3 push = Vec3::Zero();
  Vec3 twist = Vec3::Zero();
  /// Number of button presses since the last reading.
  int presses = 0;
};

/// Returns the pose `X_W` moved by the SpaceMouse for `passed_s`. Full deflection gives 20 mm/s along and 1.2
/// rad/s about the viewer's axes; R_WV rotates these to W.
Pose moved(const Pose& X_W, const SpaceMouseState& by, const Quat& R_WV, double passed_s);

/// A SpaceMouse accessed through the daemon spacenavd (or another program that listens on the socket named by
/// SPNAV_SOCKET). Only one instance at a time; for one thread, not the haptic one.
class SpaceMouse {
 public:
  /// Connects to the daemon. Without one, `is_present` returns false.
  SpaceMouse();
  ~SpaceMouse();
  SpaceMouse(const SpaceMouse&) = delete;
  SpaceMouse& operator=(const SpaceMouse&) = delete;

  bool is_present() const { return is_present_; }
  /// Returns the current state. Never blocks.
  SpaceMouseState read();

 private:
  bool is_present_ = false;
  SpaceMouseState state_;
};

}  // namespace osteomill
