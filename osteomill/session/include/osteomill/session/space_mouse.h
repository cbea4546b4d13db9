#pragma once

#include "osteomill/base/pose.h"

namespace osteomill {

/// The push and the twist of a SpaceMouse, -1 to 1 along and about each axis of the viewer: right, up,
/// towards the viewer.
struct SpaceMouseState {
  Vec3 push = Vec3::Zero();
  Vec3 twist = Vec3::Zero();
  /// The number of times that any of its buttons went down since the last reading.
  int presses = 0;
};

/// Returns a pose in W after the SpaceMouse has pushed and twisted it for this time: pushed as far as it goes
/// by 20 mm, twisted by 1.2 rad a second, along and about the axes of the viewer, which R_WV turns to those
/// of W.
Pose moved(const Pose& X_W, const SpaceMouseState& by, const Quat& R_WV, double passed_s);

/// A SpaceMouse behind the daemon spacenavd (or another program that listens at the socket that SPNAV_SOCKET
/// names). One at a time; for one thread, not the haptic one.
class SpaceMouse {
 public:
  /// Looks for the daemon; without one there is no SpaceMouse, which is no error.
  SpaceMouse();
  ~SpaceMouse();
  SpaceMouse(const SpaceMouse&) = delete;
  SpaceMouse& operator=(const SpaceMouse&) = delete;

  bool is_present() const { return is_present_; }
  /// Returns its state now. Never waits.
  SpaceMouseState read();

 private:
  bool is_present_ = false;
  SpaceMouseState state_;
};

}  // namespace osteomill
