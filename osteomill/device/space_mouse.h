#pragma once

#include "osteomill/geometry/pose.h"

namespace osteomill {

/// How far a SpaceMouse is pushed and twisted, -1 to 1 along and about each axis of the viewer: right, up,
/// towards the viewer.
struct SpaceMouseState {
  Vec3 push = Vec3::Zero();
  Vec3 twist = Vec3::Zero();
  /// How often any of its buttons went down since the last reading.
  int presses = 0;
};

/// How fast one that is pushed or twisted as far as it goes moves and turns what it moves.
inline constexpr double kSpaceMouse_mm_s = 20;
inline constexpr double kSpaceMouse_rad_s = 1.2;

/// A SpaceMouse behind the daemon spacenavd (or whatever listens at the socket that SPNAV_SOCKET names). One
/// at a time; for one thread, not the haptic one.
class SpaceMouse {
 public:
  /// Looks for the daemon; without one there is no SpaceMouse, which is no error.
  SpaceMouse();
  ~SpaceMouse();
  SpaceMouse(const SpaceMouse&) = delete;
  SpaceMouse& operator=(const SpaceMouse&) = delete;

  bool present() const { return present_; }
  /// As it is now. Never waits.
  SpaceMouseState read();

 private:
  bool present_ = false;
  SpaceMouseState state_;
};

}  // namespace osteomill
