#include "osteomill/haptics/line_proxy/line_proxy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "osteomill/haptics/line_proxy/bone_march.h"
#include "osteomill/haptics/line_proxy/equations.h"
#include "osteomill/haptics/line_proxy/point_proxy.h"
#include "osteomill/haptics/line_proxy/shaft_probe.h"
#include "osteomill/haptics/line_proxy/shaft_touch.h"
#include "osteomill/haptics/line_proxy/tool_clearance.h"
#include "osteomill/haptics/line_proxy/translation_rotation_walk.h"
#include "osteomill/tool/sample_points.h"

namespace osteomill::line_proxy {

namespace {

// How far the surface is looked for where a tick finds the tip or the shaft deep in bone without having seen
// it go in (switched on there, or moved there at once).
constexpr double kExitReach_mm = 5.0;
// Beyond this a length in mm or a force in N is no longer a number to go on with.
constexpr double kFarthest = 1e12;

Vec3 moved_toward(const Vec3& from, const Vec3& to, double limit) {
  const Vec3 way = to - from;
  const double distance = way.norm();
  return distance <= limit ? to : Vec3(from + limit / distance * way);
}

}  // namespace

LineProxy::LineProxy(const Settings& settings) : settings_(settings) {
  require_valid(settings);
}

void LineProxy::prepare(const Scene& scene) {
  if (scene.volume == nullptr) throw std::invalid_argument("line-proxy: no volume");
  require_valid(scene.tool);
  scene_ = scene;
  vertices_T_ = centreline_vertices(scene.tool, settings_.vertices);
  reset();
}

void LineProxy::reset() {
  memory_ = Memory{};
}

HapticStep LineProxy::step(const Pose& X_WD, double dt_s) {
  const Vec3& device_tip_W = X_WD.position_mm;
  const Vec3 probe_W = tip_probe_W(device_tip_W);
  follow_with_tip_proxy(probe_W, dt_s);
  const Pose X_WL{memory_.tip_proxy_W.value_or(probe_W), X_WD.orientation};
  if (settings_.shaft_contact) {
    touch_with_shaft(X_WL, device_tip_W, dt_s);
  } else {
    follow_with_intersection(X_WL);
    turn_reaction(X_WL);
  }
  memory_.tip_probe_W = probe_W;
  memory_.X_WL = X_WL;
  memory_.device_before_W = memory_.device_tip_W;
  memory_.device_tip_W = device_tip_W;

  HapticStep result;
  // The tool's tip is at its proxy, or where the shaft has pushed it.
  const Vec3 tool_tip_W = memory_.tip_proxy_W.value_or(tip_probe_W(device_tip_W));
  result.wrench.force_N = tip_force(settings_.stiffness_N_per_mm, tool_tip_W, device_tip_W);  // eq. 6
  result.wrench.torque_Nmm = torque(memory_.arm_W, memory_.reaction_N);                       // eq. 11
  if (memory_.tip_proxy_W) {
    result.burr_force_W_N = -tip_force(settings_.stiffness_N_per_mm, tool_tip_W, tip_probe_W(device_tip_W));
  }
  result.contacts =
      (memory_.tip_proxy_W ? 1 : 0) +
      (memory_.intersection_W ? std::max(1, vertices_in_bone(*scene_.volume, shaft_vertices(), X_WL)) : 0);
  forget_what_is_not_finite();
  Pose touching = touching_tool(X_WD, tool_tip_W);
  if (settings_.show_outside) keep_outside(touching, dt_s);
  result.X_WT = simulated_tool(X_WD, touching, dt_s);
  // A burr that the shaft keeps off the bone does not press on it.
  if (settings_.show_outside && memory_.tip_proxy_W &&
      !burr_touches(*scene_.volume, scene_.tool, result.X_WT, *memory_.tip_proxy_W)) {
    result.burr_force_W_N.setZero();
  }
  return result;
}

// Where the tool's tip would be without contact of its own.
Vec3 LineProxy::tip_probe_W(const Vec3& device_tip_W) const {
  return device_tip_W + memory_.touch.shift_mm();
}

void LineProxy::follow_with_tip_proxy(const Vec3& tip_probe_W, double dt_s) {
  if (memory_.tip_proxy_W) {
    if (!settings_.contact_until_proxy_is_free && !in_bone(*scene_.volume, tip_probe_W))
      memory_.tip_proxy_W.reset();
  } else {
    memory_.tip_proxy_W = first_tip_proxy(tip_probe_W);
  }
  if (!memory_.tip_proxy_W) return;
  const double probe_move_mm = memory_.tip_probe_W ? (tip_probe_W - *memory_.tip_probe_W).norm() : 0.0;
  memory_.tip_proxy_W =
      move_point_proxy(*scene_.volume, *memory_.tip_proxy_W, tip_probe_W,
                       {settings_.normal, settings_.tip_proxy_limit_mm_per_s * dt_s + probe_move_mm});
  if (*memory_.tip_proxy_W == tip_probe_W) memory_.tip_proxy_W.reset();
}

std::optional<Vec3> LineProxy::first_tip_proxy(const Vec3& tip_probe_W) const {
  const Volume& volume = *scene_.volume;
  const bool inside = in_bone(volume, tip_probe_W);
  if (!inside && !settings_.contact_until_proxy_is_free) return std::nullopt;
  if (memory_.tip_probe_W && !in_bone(volume, *memory_.tip_probe_W)) {
    return crossing_in_grid(volume, *memory_.tip_probe_W, tip_probe_W);
  }
  if (!inside) return std::nullopt;
  return nearest_exit(volume, tip_probe_W, kExitReach_mm);
}

void LineProxy::follow_with_intersection(const Pose& X_WL) {
  if (memory_.intersection_W) {
    memory_.intersection_W = next_intersection(X_WL);
  } else if (vertices_in_bone(*scene_.volume, shaft_vertices(), X_WL) > 0) {
    memory_.intersection_W = first_intersection(X_WL);
  }
}

// No collision at t-1, but at t.
std::optional<Vec3> LineProxy::first_intersection(const Pose& X_WL) const {
  if (!memory_.X_WL) return std::nullopt;  // the first tick has no path to walk
  const auto hit =
      walk_to_collision(*scene_.volume, shaft_vertices(), *memory_.X_WL, X_WL,
                        {settings_.translation_steps, settings_.rotation_steps},
                        settings_.clamp_fraction ? FractionRule::kept_within_step : FractionRule::as_printed);
  if (!hit) return std::nullopt;
  return intersection_point(hit->before_W, hit->at_W, hit->fraction);  // eq. 2
}

// Collision at t-1 already. The point-proxy rule takes IP from where it was toward the densest point; nothing
// where the shaft is free.
std::optional<Vec3> LineProxy::next_intersection(const Pose& X_WL) const {
  const Volume& volume = *scene_.volume;
  const ShaftProbe probe = densest_point(volume, shaft_vertices(), X_WL, *memory_.intersection_W);
  if (!(probe.density > volume.isovalue())) return std::nullopt;
  return move_point_proxy(volume, *memory_.intersection_W, probe.point_W,
                          {settings_.normal, std::numeric_limits<double>::infinity()});
}

void LineProxy::turn_reaction(const Pose& X_WL) {
  memory_.reaction_N.setZero();
  if (!memory_.intersection_W) return;
  memory_.arm_W = arm(*memory_.intersection_W, X_WL.position_mm);                                   // eq. 7
  const Vec3 probe_W = probe_intersection(memory_.arm_W, shaft_direction(X_WL), X_WL.position_mm);  // eq. 8
  const Vec3 g = orientation_error(*memory_.intersection_W, probe_W);                               // eq. 9
  memory_.reaction_N =
      shaft_share(memory_.arm_W.norm()) * reaction_force(settings_.stiffness_N_per_mm, g);  // eq. 10
}

// In the place of eq. 8 to 10.
void LineProxy::touch_with_shaft(const Pose& X_WL, const Vec3& device_tip_W, double dt_s) {
  const Volume& volume = *scene_.volume;
  const double spacing_mm = (vertices_T_[1] - vertices_T_[0]).norm();
  const ShaftSpan span{vertices_T_[1].z(), vertices_T_.back().z(), spacing_mm / 4};
  LaidLine line{X_WL, device_tip_W, std::nullopt};
  if (memory_.tip_proxy_W) {
    const Vec3 raised = *memory_.tip_proxy_W - tip_probe_W(device_tip_W);
    if (raised.norm() > 1e-9) line.rest = TipRest{*memory_.tip_proxy_W, raised.normalized()};
  }
  ShaftTouch& touch = memory_.touch;
  touch.follow(volume, span, line, touch.touches() ? 0.0 : first_lever_mm(X_WL), touch_rule(dt_s), dt_s);
  memory_.reaction_N = touch.reaction_N();
  memory_.intersection_W.reset();
  if (!touch.touches()) return;
  memory_.intersection_W = touch.point_W();
  memory_.arm_W = touch.lever_mm() * shaft_direction(X_WL);
}

// Where the walk finds the first contact.
double LineProxy::first_lever_mm(const Pose& X_WL) const {
  if (vertices_in_bone(*scene_.volume, shaft_vertices(), X_WL) == 0) return 0.0;
  const auto first_W = first_intersection(X_WL);
  return first_W ? shaft_direction(X_WL).dot(*first_W - X_WL.position_mm) : 0.0;
}

ShaftTouchRule LineProxy::touch_rule(double dt_s) const {
  constexpr double kStiffest = 25.0;
  // The slower the loop, the softer a spring it can hold (Colgate and Schenkel 1997).
  constexpr double kMeantFor_s = 1e-3;
  const double turning = settings_.shaft_turning_Nmm_per_rad * std::min(1.0, kMeantFor_s / dt_s);
  const double k = settings_.stiffness_N_per_mm;
  return {settings_.normal,
          k,
          turning,
          kStiffest * k,
          settings_.shaft_fade_radii * scene_.tool.shaft_radius_mm,
          settings_.contact_turning_share,
          settings_.contact_slide_limit_mm_per_s,
          settings_.shaft_force_slew_N_per_s};
}

double LineProxy::shaft_share(double arm_mm) const {
  const double full_mm = settings_.shaft_fade_radii * scene_.tool.shaft_radius_mm;
  return arm_mm < full_mm ? arm_mm / full_mm : 1.0;
}

// The tool moved out of the bone by its radii.
Pose LineProxy::touching_tool(const Pose& X_WD, const Vec3& tool_tip_W) const {
  const Volume& volume = *scene_.volume;
  Pose X_WT{tool_tip_W, X_WD.orientation};
  if (memory_.tip_proxy_W) {
    const auto u = surface_normal(volume, tool_tip_W, settings_.normal);
    if (u) X_WT.position_mm = offset_point(tool_tip_W, *u, scene_.tool.burr_radius_mm);
  }
  if (!memory_.intersection_W) return X_WT;
  const auto u = surface_normal(volume, *memory_.intersection_W, settings_.normal);
  if (!u) return X_WT;
  const Vec3 offset_W = offset_point(*memory_.intersection_W, *u, scene_.tool.shaft_radius_mm);  // eq. 12
  const Vec3 shaft_W = drawn_shaft(offset_W, X_WT.position_mm);                                  // eq. 13
  const double share = shaft_share(memory_.arm_W.norm());
  const Vec3 direction = shaft_direction(X_WD);
  const Vec3 drawn = (1.0 - share) * direction + share * shaft_W.normalized();
  if (!(drawn.norm() > 1e-6)) return X_WT;
  X_WT.orientation = (smallest_rotation(direction, drawn) * X_WD.orientation).normalized();
  return X_WT;
}

// One move a tick, kept from tick to tick and given back little by little.
void LineProxy::keep_outside(Pose& X_WT, double dt_s) {
  constexpr double kReturnTime_s = 0.02;
  Vec3& clearance_W = memory_.clearance_W;
  clearance_W *= std::max(0.0, 1.0 - dt_s / kReturnTime_s);
  X_WT.position_mm += clearance_W;
  const auto move = clearing_move(*scene_.volume, scene_.tool, X_WT, settings_.normal);
  if (!move) return;
  clearance_W += *move;
  X_WT.position_mm += *move;
}

Pose LineProxy::simulated_tool(const Pose& X_WD, const Pose& touching, double dt_s) {
  const double device_move_mm =
      memory_.device_before_W ? (X_WD.position_mm - *memory_.device_before_W).norm() : 0.0;
  memory_.tool_shift_W = moved_toward(memory_.tool_shift_W, touching.position_mm - X_WD.position_mm,
                                      settings_.tool_glide_mm_per_s * dt_s + device_move_mm);
  memory_.tool_turn_W =
      moved_toward(memory_.tool_turn_W, rotation_vector(touching.orientation * X_WD.orientation.conjugate()),
                   settings_.tool_glide_rad_per_s * dt_s);
  return {X_WD.position_mm + memory_.tool_shift_W,
          (quaternion_from_rotation_vector(memory_.tool_turn_W) * X_WD.orientation).normalized()};
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
