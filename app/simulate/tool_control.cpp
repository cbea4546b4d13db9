#include "app/simulate/tool_control.h"

namespace osteomill::app {

namespace {

constexpr double kTurn_rad_per_px = 0.006;
constexpr double kWheelStep_mm = 0.2;
constexpr double kKeys_mm_s = 6;
constexpr double kKeysAway_mm_s = 3;
constexpr double kKeysTurn_rad_s = 0.6;
// Maximum lead of the target over the device: against bone, a larger one would not increase the spring force;
// in free space the tool follows.
constexpr double kMaxLead_mm = 6;
constexpr double kMaxLeadFree_mm = 25;
constexpr double kMaxLead_rad = 0.35;

}  // namespace

Pose moved_target(const Pose& X_W_target, const Pose& X_WD, const Camera& camera, const PixelSize& size,
                  const ToolInput& input) {
  const double scale = mm_per_pixel(camera, size, depth_of(camera, X_W_target.position_mm));
  Vec3 move = -input.wheel * kWheelStep_mm * camera.towards_viewer_W() -
              input.passed_s * kKeysAway_mm_s * input.keys.z() * camera.towards_viewer_W();
  Vec3 turn = Vec3::Zero();
  if (input.turning) {
    turn = kTurn_rad_per_px * (input.moved_px.x() * camera.up_W() + input.moved_px.y() * camera.right_W()) +
           input.passed_s * kKeysTurn_rad_s *
               (input.keys.x() * camera.up_W() - input.keys.y() * camera.right_W());
  } else {
    move +=
        scale * (input.moved_px.x() * camera.right_W() - input.moved_px.y() * camera.up_W()) +
        input.passed_s * kKeys_mm_s * (input.keys.x() * camera.right_W() + input.keys.y() * camera.up_W());
  }
  Pose target = moved({X_W_target.position_mm + move,
                       (quaternion_from_rotation_vector(turn) * X_W_target.orientation).normalized()},
                      input.space_mouse, camera.orientation, input.passed_s);
  const Vec3 ahead = target.position_mm - X_WD.position_mm;
  const double max_lead_mm = input.touching ? kMaxLead_mm : kMaxLeadFree_mm;
  if (ahead.norm() > max_lead_mm) target.position_mm = X_WD.position_mm + max_lead_mm * ahead.normalized();
  const Vec3 turned = rotation_vector(target.orientation * X_WD.orientation.conjugate());
  if (turned.norm() > kMaxLead_rad) {
    target.orientation =
        quaternion_from_rotation_vector(kMaxLead_rad * turned.normalized()) * X_WD.orientation;
  }
  return target;
}

}  // namespace osteomill::app
