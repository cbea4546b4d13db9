#include "osteomill/session/space_mouse.h"

#include <algorithm>

#include <spnav.h>

namespace osteomill {

namespace {

// The daemon's value at full deflection.
constexpr double kFull = 350;
constexpr double kPush_mm_s = 20;
constexpr double kTwist_rad_s = 1.2;

double share(int value) {
  return std::clamp(value / kFull, -1.0, 1.0);
}

}  // namespace

Pose moved(const Pose& X_W, const SpaceMouseState& by, const Quat& R_WV, double passed_s) {
  const Vec3 turn_W = R_WV * Vec3(passed_s * kTwist_rad_s * by.twist);
  return {X_W.position_mm + R_WV * Vec3(passed_s * kPush_mm_s * by.push),
          (quaternion_from_rotation_vector(turn_W) * X_W.orientation).normalized()};
}

SpaceMouse::SpaceMouse() : is_present_(spnav_open() != -1) {}

SpaceMouse::~SpaceMouse() {
  if (is_present_) spnav_close();
}

SpaceMouseState SpaceMouse::read() {
  spnav_event event;
  while (is_present_ && spnav_poll_event(&event) != 0) {
    if (event.type == SPNAV_EVENT_MOTION) {
      // The daemon's frame is left-handed: z points away from the viewer.
      state_.push = {share(event.motion.x), share(event.motion.y), -share(event.motion.z)};
      state_.twist = {share(event.motion.rx), share(event.motion.ry), -share(event.motion.rz)};
    } else if (event.type == SPNAV_EVENT_BUTTON && event.button.press != 0) {
      ++state_.presses;
    }
  }
  SpaceMouseState now = state_;
  state_.presses = 0;
  return now;
}

}  // namespace osteomill
