#include "osteomill/haptics/line_proxy/line_proxy.h"

#include <algorithm>
#include <stdexcept>

#include "osteomill/haptics/line_proxy/intersection.h"
#include "osteomill/haptics/line_proxy/tool_clearance.h"
#include "osteomill/tool/sample_points.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::line_proxy {

namespace {

// How far the surface is looked for where a tick finds the tip or the shaft deep in bone without having seen
// it go in (switched on there, or moved there at once).
constexpr double kExitReach_mm = 5.0;
// Beyond this a length in mm or a force in N is no longer a number to go on with.
constexpr double kFarthest = 1e12;
// NUMBER_OF_TRANSLATION_STEPS and NUMBER_OF_ROTATION_STEPS of (3) and (4).
constexpr WalkSteps kWalk{10, 10};
// The stiffness below 1 kHz: the slower the loop, the softer a spring it can hold (Colgate and Schenkel
// 1997).
constexpr double kMeantFor_s = 1e-3;
// The line is looked at this often between two of its vertices: at the vertices alone a thin sheet is gone
// through.
constexpr int kLooksPerVertex = 4;
// The drawn tool that is kept outside goes over between touching and free at these speeds, beyond the
// device's own movement. It is what cuts: standing as the line does, in place of (13), it left three times as
// much bone within what it had swept, and its hole changed with the voxels by a sixth.
constexpr double kGlide_mm_s = 100;
constexpr double kGlide_rad_s = 20;
// From the tip to so many shaft radii the drawn shaft turns from the device's direction to that of (13);
// turned in full, the drawn tool of four times as many pushes ends in bone.
constexpr double kDrawnFade_radii = 4;

Vec3 moved_toward(const Vec3& from, const Vec3& to, double limit) {
  const Vec3 way = to - from;
  const double distance = way.norm();
  return distance <= limit ? to : Vec3(from + limit / distance * way);
}

}  // namespace

LineProxy::LineProxy(const Settings& settings) : settings_(settings) {}

void LineProxy::prepare(const Scene& scene) {
  if (scene.volume == nullptr) throw std::invalid_argument("line-proxy: no volume");
  require_valid(scene.tool);
  scene_ = scene;
  vertices_T_ = centreline_vertices(scene.tool, settings_.vertices);
  normal_ = settings_.smoothed_normals ? NormalRule{} : NormalRule{GradientKernel::central, 0};
  turning_Nmm_per_rad_ = settings_.turning_Nmm_per_rad * std::min(1.0, kMeantFor_s / scene.tick_period_s);
  const double spacing_mm = (vertices_T_[1] - vertices_T_[0]).norm();
  held_line_.prepare(*scene.volume,
                     {vertices_T_[1].z(), vertices_T_.back().z(), spacing_mm / kLooksPerVertex}, normal_,
                     {settings_.stiffness_N_per_mm, turning_Nmm_per_rad_});
  reset();
}

void LineProxy::reset() {
  memory_ = Memory{};
  held_line_.reset();
}

HapticStep LineProxy::step(const Pose& X_WD, double dt_s) {
  HapticStep result;
  if (settings_.hold_line) {
    follow_with_line(X_WD, dt_s, result);
  } else {
    follow_as_printed(X_WD, result);
  }
  memory_.device_before_W = memory_.device_tip_W;
  memory_.device_tip_W = X_WD.position_mm;
  const Pose& X_WF = *result.X_WF;
  result.contacts = (memory_.tip_proxy_W ? 1 : 0) +
                    (memory_.intersection_W ? std::max(1, count_in_bone(*scene_.volume, shaft_vertices(),
                                                                        {X_WF.position_mm, X_WD.orientation}))
                                            : 0);
  forget_what_is_not_finite();
  result.intersection_W = memory_.intersection_W;
  Pose touching = touching_tool(X_WD, X_WF.position_mm);
  if (settings_.show_outside) keep_outside(touching, dt_s);
  result.X_WT = settings_.show_outside ? gliding_tool(X_WD, touching, dt_s) : touching;
  // A burr that the shaft, or a wall beside it, keeps off the bone does not press on it.
  if (settings_.show_outside && !memory_.burr.presses(*scene_.volume, scene_.tool.burr_radius_mm,
                                                      result.X_WT.position_mm, result.burr_force_W_N, dt_s)) {
    result.burr_force_W_N.setZero();
  }
  return result;
}

void LineProxy::follow_with_line(const Pose& X_WD, double dt_s, HapticStep& result) {
  held_line_.follow(X_WD, dt_s);
  const Pose& X_WL = held_line_.X_WL();
  result.X_WF = X_WL;
  memory_.tip_proxy_W.reset();
  memory_.intersection_W.reset();
  if (!held_line_.is_held_back()) return;
  const ToolMove stretch = move_between(X_WD, X_WL);
  result.wrench = {settings_.stiffness_N_per_mm * stretch.translation_mm,  // eq. 6
                   turning_Nmm_per_rad_ * stretch.rotation_rad};
  Vec3 shaft_N = Vec3::Zero();
  if (const auto& push = held_line_.shaft_push()) {
    memory_.arm_W = push->lever_mm * shaft_direction(X_WL);
    memory_.intersection_W = X_WL.position_mm + memory_.arm_W;
    shaft_N = push->force_N;
  }
  if (!held_line_.tip_rests()) return;
  memory_.tip_proxy_W = X_WL.position_mm;
  result.burr_force_W_N = shaft_N - result.wrench.force_N;
}

void LineProxy::follow_as_printed(const Pose& X_WD, HapticStep& result) {
  const Vec3& tip_W = X_WD.position_mm;
  follow_with_tip_proxy(tip_W);
  const Pose X_WL{memory_.tip_proxy_W.value_or(tip_W), X_WD.orientation};
  follow_with_intersection(X_WL);
  turn_reaction(X_WL);
  memory_.X_WL = X_WL;
  result.wrench.force_N = settings_.stiffness_N_per_mm * (X_WL.position_mm - tip_W);  // eq. 6
  result.wrench.torque_Nmm = memory_.arm_W.cross(memory_.reaction_N);                 // eq. 11
  if (memory_.tip_proxy_W) result.burr_force_W_N = -result.wrench.force_N;
  // The tip where (6) pulls to, the shaft through the intersection point.
  result.X_WF = X_WL;
  if (memory_.intersection_W && memory_.arm_W.norm() > 0 && memory_.arm_W.norm() < kFarthest) {
    const Quat turn = smallest_rotation(shaft_direction(X_WL), memory_.arm_W.normalized());
    result.X_WF->orientation = (turn * X_WD.orientation).normalized();
  }
}

void LineProxy::follow_with_tip_proxy(const Vec3& tip_W) {
  const Volume& volume = *scene_.volume;
  if (!is_bone_at(volume, tip_W)) {
    memory_.tip_proxy_W.reset();
    return;
  }
  if (!memory_.tip_proxy_W) memory_.tip_proxy_W = first_tip_proxy(tip_W);
  if (!memory_.tip_proxy_W) return;
  memory_.tip_proxy_W = move_point_proxy(volume, *memory_.tip_proxy_W, tip_W, normal_, settings_.friction);
  if (*memory_.tip_proxy_W == tip_W) memory_.tip_proxy_W.reset();
}

std::optional<Vec3> LineProxy::first_tip_proxy(const Vec3& tip_W) const {
  const Volume& volume = *scene_.volume;
  if (memory_.device_tip_W && !is_bone_at(volume, *memory_.device_tip_W)) {
    return first_crossing(volume, *memory_.device_tip_W, tip_W);
  }
  return nearest_exit(volume, tip_W, kExitReach_mm);
}

void LineProxy::follow_with_intersection(const Pose& X_WL) {
  if (memory_.intersection_W) {
    memory_.intersection_W = next_intersection(X_WL);
  } else if (count_in_bone(*scene_.volume, shaft_vertices(), X_WL) > 0) {
    memory_.intersection_W = first_intersection(X_WL);
  }
}

// No collision at t-1, but at t.
std::optional<Vec3> LineProxy::first_intersection(const Pose& X_WL) const {
  if (!memory_.X_WL) return std::nullopt;  // the first tick has no path to walk
  const auto hit = walk_to_collision(*scene_.volume, shaft_vertices(), *memory_.X_WL, X_WL, kWalk);
  if (!hit) return std::nullopt;
  return hit->intersection_W();
}

// Collision at t-1 already. The point-proxy rule takes IP from where it was toward the densest point; nothing
// where the shaft is free.
std::optional<Vec3> LineProxy::next_intersection(const Pose& X_WL) const {
  const Volume& volume = *scene_.volume;
  const ShaftProbe probe = densest_point(volume, shaft_vertices(), X_WL, *memory_.intersection_W);
  if (!(probe.density > volume.isovalue())) return std::nullopt;
  return move_point_proxy(volume, *memory_.intersection_W, probe.point_W, normal_, settings_.friction);
}

void LineProxy::turn_reaction(const Pose& X_WL) {
  memory_.reaction_N.setZero();
  if (!memory_.intersection_W) return;
  // The point as far up the device's shaft as IP is, and g, the error of orientation alone.
  memory_.arm_W = *memory_.intersection_W - X_WL.position_mm;                            // eq. 7
  const Vec3 probe_W = memory_.arm_W.norm() * shaft_direction(X_WL) + X_WL.position_mm;  // eq. 8
  const Vec3 g = *memory_.intersection_W - probe_W;                                      // eq. 9
  memory_.reaction_N = settings_.stiffness_N_per_mm * g;                                 // eq. 10
}

// How much of the way the drawn shaft turns; in full where the tool is not kept outside.
double LineProxy::drawn_share(double arm_mm) const {
  const double full_mm = settings_.show_outside ? kDrawnFade_radii * scene_.tool.shaft_radius_mm : 0;
  return arm_mm < full_mm ? arm_mm / full_mm : 1.0;
}

// The tool moved out of the bone by its radii.
Pose LineProxy::touching_tool(const Pose& X_WD, const Vec3& tool_tip_W) const {
  const Volume& volume = *scene_.volume;
  Pose X_WT{tool_tip_W, X_WD.orientation};
  if (memory_.tip_proxy_W) {
    const auto u = surface_normal(volume, tool_tip_W, normal_);
    if (u) X_WT.position_mm = tool_tip_W + *u * scene_.tool.burr_radius_mm;
  }
  if (!memory_.intersection_W) return X_WT;
  const auto u = surface_normal(volume, *memory_.intersection_W, normal_);
  if (!u) return X_WT;
  const Vec3 offset_W = *memory_.intersection_W + *u * scene_.tool.shaft_radius_mm;  // eq. 12
  const Vec3 shaft_W = offset_W - X_WT.position_mm;                                  // eq. 13
  const double share = drawn_share(memory_.arm_W.norm());
  const Vec3 direction = shaft_direction(X_WD);
  const Vec3 drawn = (1.0 - share) * direction + share * shaft_W.normalized();
  if (!(drawn.norm() > 1e-6)) return X_WT;
  X_WT.orientation = (smallest_rotation(direction, drawn) * X_WD.orientation).normalized();
  return X_WT;
}

// One move a tick, kept from tick to tick and given back little by little. Without it the drawn tool of a
// third of all pushes ends in bone.
void LineProxy::keep_outside(Pose& X_WT, double dt_s) {
  constexpr double kReturnTime_s = 0.02;
  Vec3& clearance_W = memory_.clearance_W;
  clearance_W *= std::max(0.0, 1.0 - dt_s / kReturnTime_s);
  X_WT.position_mm += clearance_W;
  const auto move = clearing_move(*scene_.volume, scene_.tool, X_WT, normal_);
  if (!move) return;
  clearance_W += *move;
  X_WT.position_mm += *move;
}

Pose LineProxy::gliding_tool(const Pose& X_WD, const Pose& touching, double dt_s) {
  const double device_move_mm =
      memory_.device_before_W ? (X_WD.position_mm - *memory_.device_before_W).norm() : 0.0;
  const ToolMove goal = move_between(X_WD, touching);
  ToolMove& tool = memory_.tool;
  tool = {moved_toward(tool.translation_mm, goal.translation_mm, kGlide_mm_s * dt_s + device_move_mm),
          moved_toward(tool.rotation_rad, goal.rotation_rad, kGlide_rad_s * dt_s)};
  return moved(X_WD, tool);
}

// As printed, eq. 1 can divide by nothing. What comes of it is seen by who sends the wrench; it must not
// last.
void LineProxy::forget_what_is_not_finite() {
  const auto is_usable = [](const Vec3& vector) { return vector.norm() < kFarthest; };
  if (memory_.intersection_W && !is_usable(*memory_.intersection_W)) memory_.intersection_W.reset();
  if (!is_usable(memory_.arm_W)) memory_.arm_W.setZero();
  if (!is_usable(memory_.reaction_N)) memory_.reaction_N.setZero();
}

}  // namespace osteomill::line_proxy
