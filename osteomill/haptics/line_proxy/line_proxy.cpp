#include "osteomill/haptics/line_proxy/line_proxy.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "osteomill/haptics/line_proxy/bone_march.h"
#include "osteomill/haptics/line_proxy/equations.h"
#include "osteomill/haptics/line_proxy/point_proxy.h"
#include "osteomill/haptics/line_proxy/shaft_probe.h"
#include "osteomill/haptics/line_proxy/translation_rotation_walk.h"
#include "osteomill/tool/sample_points.h"

namespace osteomill {

namespace {

using namespace line_proxy;

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

LineProxy::LineProxy(const LineProxySettings& settings) : settings_(settings) {
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

HapticStep LineProxy::step(const Pose& X_WD, double /*dt_s*/) {
  follow_with_tip_proxy(X_WD.position_mm);
  const Vec3 proxy_W = memory_.tip_proxy_W.value_or(X_WD.position_mm);
  const Pose X_WL{proxy_W, X_WD.orientation};
  follow_with_intersection(X_WL);
  turn_reaction(X_WL);

  HapticStep result;
  result.wrench.force_N = tip_force(settings_.stiffness_N_per_mm, proxy_W, X_WD.position_mm);  // eq. 6
  result.burr_force_N = result.wrench.force_N.norm();
  if (settings_.shaft_pushes) {
    push_with_shaft(proxy_W - X_WD.position_mm);
    result.wrench.force_N += memory_.shaft_push_N;
  }
  result.wrench.torque_Nmm = torque(memory_.arm_W, memory_.reaction_N);  // eq. 11
  result.contacts = (memory_.tip_proxy_W ? 1 : 0) +
                    (memory_.intersection_W ? vertices_in_bone(*scene_.volume, shaft_vertices(), X_WL) : 0);
  forget_what_is_not_finite();
  result.X_WT = simulated_tool(X_WD);
  memory_.device_tip_W = X_WD.position_mm;
  memory_.X_WL = X_WL;
  return result;
}

void LineProxy::follow_with_tip_proxy(const Vec3& device_tip_W) {
  if (memory_.tip_proxy_W) {
    if (!settings_.contact_until_proxy_is_free && !in_bone(*scene_.volume, device_tip_W))
      memory_.tip_proxy_W.reset();
  } else {
    memory_.tip_proxy_W = first_tip_proxy(device_tip_W);
  }
  if (!memory_.tip_proxy_W) return;
  const double device_move_mm = memory_.device_tip_W ? (device_tip_W - *memory_.device_tip_W).norm() : 0.0;
  memory_.tip_proxy_W = move_point_proxy(*scene_.volume, *memory_.tip_proxy_W, device_tip_W,
                                         {settings_.normal, settings_.tip_proxy_limit_mm + device_move_mm});
  if (*memory_.tip_proxy_W == device_tip_W) memory_.tip_proxy_W.reset();
}

std::optional<Vec3> LineProxy::first_tip_proxy(const Vec3& device_tip_W) const {
  const Volume& volume = *scene_.volume;
  const bool inside = in_bone(volume, device_tip_W);
  if (!inside && !settings_.contact_until_proxy_is_free) return std::nullopt;
  if (memory_.device_tip_W && !in_bone(volume, *memory_.device_tip_W)) {
    return crossing_in_grid(volume, *memory_.device_tip_W, device_tip_W);
  }
  if (!inside) return std::nullopt;
  return nearest_exit(volume, device_tip_W, kExitReach_mm);
}

void LineProxy::follow_with_intersection(const Pose& X_WL) {
  if (memory_.intersection_W) {
    slide_intersection(X_WL);
  } else if (vertices_in_bone(*scene_.volume, shaft_vertices(), X_WL) > 0) {
    memory_.intersection_W = first_intersection(X_WL);
    memory_.middle_proxy_W = memory_.intersection_W.value_or(Vec3::Zero());
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
  Vec3 intersection_W = intersection_point(hit->before_W, hit->at_W, hit->fraction);  // eq. 2
  if (is_refused(intersection_W, hit->at_W, X_WL)) return std::nullopt;
  return intersection_W;
}

// Collision at t-1 already.
void LineProxy::slide_intersection(const Pose& X_WL) {
  const auto next_W = settings_.shaft_probe == ShaftProbeRule::densest ? next_intersection(X_WL)
                                                                       : next_intersection_across(X_WL);
  if (!next_W) {
    memory_.intersection_W.reset();
  } else if (!is_refused(*next_W, *memory_.intersection_W, X_WL)) {
    memory_.intersection_W = next_W;
  }
}

// The point-proxy rule takes IP from where it was toward the densest point; nothing where the shaft is free.
std::optional<Vec3> LineProxy::next_intersection(const Pose& X_WL) {
  const Volume& volume = *scene_.volume;
  const ShaftProbe probe = densest_point(volume, shaft_vertices(), X_WL, *memory_.intersection_W);
  if (!(probe.density > volume.isovalue())) return std::nullopt;
  return move_point_proxy(volume, *memory_.intersection_W, probe.point_W,
                          {settings_.normal, settings_.intersection_slide_limit_mm});
}

// The point-proxy rule on the middle of the shaft's way through the bone says which way is out; IP is that
// proxy, or the surface where that way is the longest.
std::optional<Vec3> LineProxy::next_intersection_across(const Pose& X_WL) {
  const Volume& volume = *scene_.volume;
  const auto run = nearest_run(volume, shaft_vertices(), X_WL, *memory_.intersection_W);
  if (!run) return std::nullopt;
  const double middle = middle_of(volume, shaft_vertices(), X_WL, *run);
  const Vec3 middle_W = sample_W(shaft_vertices(), X_WL, middle);
  memory_.middle_proxy_W = move_point_proxy(volume, memory_.middle_proxy_W, middle_W,
                                            {settings_.normal, settings_.intersection_slide_limit_mm});
  const Vec3 axis = shaft_direction(X_WL);
  const Vec3 out = memory_.middle_proxy_W - middle_W;
  const Vec3 across = out - out.dot(axis) * axis;
  // Where out is along the shaft, the proxy of the middle is all there is.
  Vec3 goal_W = memory_.middle_proxy_W;
  if (settings_.shaft_probe == ShaftProbeRule::deepest_across && across.norm() > 0.1 * out.norm()) {
    // The edge of a wedge of bone is at most twice as deep as the middle; more is bone on another side.
    const double limit_mm = 2.5 * across.norm() + 0.5 * volume.geometry().spacing_mm.minCoeff();
    goal_W = deepest_across(volume, shaft_vertices(), X_WL, *run, middle, across.normalized(), limit_mm)
                 .value_or(goal_W);
  }
  return moved_toward(*memory_.intersection_W, goal_W,
                      settings_.intersection_slide_limit_mm + line_move_mm(X_WL));
}

// How far the centreline's tip has come since the last tick.
double LineProxy::line_move_mm(const Pose& X_WL) const {
  return memory_.X_WL ? (X_WL.position_mm - memory_.X_WL->position_mm).norm() : 0.0;
}

bool LineProxy::is_refused(const Vec3& intersection_W, const Vec3& expected_W, const Pose& X_WL) const {
  if ((intersection_W - expected_W).norm() > settings_.intersection_jump_limit_mm) return true;
  return settings_.refuse_behind_tip && (intersection_W - X_WL.position_mm).dot(shaft_direction(X_WL)) < 0.0;
}

// The reaction of the shaft, which lags behind eq. 10 where its slew is limited.
void LineProxy::turn_reaction(const Pose& X_WL) {
  Vec3 reaction_N = Vec3::Zero();
  if (memory_.intersection_W) {
    memory_.arm_W = arm(*memory_.intersection_W, X_WL.position_mm);                                   // eq. 7
    const Vec3 probe_W = probe_intersection(memory_.arm_W, shaft_direction(X_WL), X_WL.position_mm);  // eq. 8
    const Vec3 g = orientation_error(*memory_.intersection_W, probe_W);                               // eq. 9
    reaction_N =
        shaft_share(memory_.arm_W.norm()) * reaction_force(settings_.stiffness_N_per_mm, g);  // eq. 10
  }
  memory_.reaction_N = moved_toward(memory_.reaction_N, reaction_N, settings_.shaft_force_slew_N);
}

// What of the reaction the hand feels as a force. The centreline is laid at the tip's proxy, which goes along
// with the hand in the tangent plane only: a push along the tip's own spring would answer to no movement of
// the hand, and such a spring, stiff one way and not the other, feeds energy into the hand.
void LineProxy::push_with_shaft(const Vec3& tip_spring_W) {
  Vec3 push_N = memory_.reaction_N;
  const double spring_mm = tip_spring_W.norm();
  if (spring_mm > 0.0) push_N -= push_N.dot(tip_spring_W / spring_mm) * (tip_spring_W / spring_mm);
  memory_.shaft_push_N = moved_toward(memory_.shaft_push_N, push_N, settings_.shaft_force_slew_N);
}

double LineProxy::shaft_share(double arm_mm) const {
  const double full_mm = settings_.shaft_fade_radii * scene_.tool.shaft_radius_mm;
  return arm_mm < full_mm ? arm_mm / full_mm : 1.0;
}

// The tool moved out of the bone by its radii.
Pose LineProxy::touching_tool(const Pose& X_WD) const {
  const Volume& volume = *scene_.volume;
  Pose X_WT = X_WD;
  if (memory_.tip_proxy_W) {
    const auto u = surface_normal(volume, *memory_.tip_proxy_W, settings_.normal);
    X_WT.position_mm =
        u ? offset_point(*memory_.tip_proxy_W, *u, scene_.tool.burr_radius_mm) : *memory_.tip_proxy_W;
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

Pose LineProxy::simulated_tool(const Pose& X_WD) {
  const Pose touching = touching_tool(X_WD);
  const double device_move_mm =
      memory_.device_tip_W ? (X_WD.position_mm - *memory_.device_tip_W).norm() : 0.0;
  memory_.tool_shift_W = moved_toward(memory_.tool_shift_W, touching.position_mm - X_WD.position_mm,
                                      settings_.tool_glide_mm + device_move_mm);
  memory_.tool_turn_W =
      moved_toward(memory_.tool_turn_W, rotation_vector(touching.orientation * X_WD.orientation.conjugate()),
                   settings_.tool_glide_rad);
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

}  // namespace osteomill
