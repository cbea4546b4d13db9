#include "published/line_proxy/line_proxy.h"

#include <algorithm>
#include <stdexcept>

#include "osteomill/haptics/sample_points.h"
#include "osteomill/volume/sampling.h"

#include "doubts.h"
#include "published/line_proxy/intersection.h"
#include "published/line_proxy/point_proxy.h"

namespace osteomill::line_proxy {

namespace {

// How far the surface is looked for if a tick finds the tip deep in bone without having seen it go in
// (switched on there, or moved there at once).
constexpr double kExitReach_mm = 5.0;
// Beyond this a length in mm or a force in N is no longer a number to go on with.
constexpr double kFarthest = 1e12;
// NUMBER_OF_TRANSLATION_STEPS and NUMBER_OF_ROTATION_STEPS of (3) and (4).
constexpr WalkSteps kWalk{10, 10};

}  // namespace

std::vector<std::string> LineProxy::doubts_about(const MillingTool&, const GridGeometry&) const {
  std::vector<std::string> doubts;
  doubt_stiffness(doubts, "line-proxy: a stiffness", settings_.stiffness_N_per_mm);
  // A tick in which the shaft first touches looks at all vertices in each step of the walk.
  doubt_reads(doubts, "line-proxy: this number of vertices",
              (kWalk.translation + kWalk.rotation) * settings_.vertices);
  return doubts;
}

void LineProxy::prepare(const Scene& scene) {
  if (scene.volume == nullptr) throw std::invalid_argument("line-proxy: no volume");
  require_valid(scene.tool);
  scene_ = scene;
  vertices_T_ = centreline_vertices(scene.tool, settings_.vertices);
  reset();
}

HapticStep LineProxy::step(const Pose& X_WD, double) noexcept {
  const Vec3& tip_W = X_WD.position_mm;
  follow_with_tip_proxy(tip_W);
  const Pose X_WL{memory_.tip_proxy_W.value_or(tip_W), X_WD.orientation};
  follow_with_intersection(X_WL);
  turn_reaction(X_WL);
  memory_.X_WL = X_WL;
  memory_.device_tip_W = tip_W;
  HapticStep result;
  result.wrench.force_N = settings_.stiffness_N_per_mm * (X_WL.position_mm - tip_W);  // eq. 6
  result.wrench.torque_Nmm = memory_.arm_W.cross(memory_.reaction_N);                 // eq. 11
  if (memory_.tip_proxy_W) result.burr_force_W_N = -result.wrench.force_N;
  const int on_shaft =
      memory_.intersection_W ? std::max(1, count_in_bone(*scene_.volume, shaft_vertices(), X_WL)) : 0;
  result.contacts = (memory_.tip_proxy_W ? 1 : 0) + on_shaft;
  forget_what_is_not_finite();
  result.intersection_W = memory_.intersection_W;
  result.X_WT = drawn_tool(X_WL);
  return result;
}

void LineProxy::follow_with_tip_proxy(const Vec3& tip_W) {
  const Volume& volume = *scene_.volume;
  if (!is_bone_at(volume, tip_W)) {
    memory_.tip_proxy_W.reset();
    return;
  }
  if (!memory_.tip_proxy_W) memory_.tip_proxy_W = first_tip_proxy(tip_W);
  if (!memory_.tip_proxy_W) return;
  memory_.tip_proxy_W = move_point_proxy(volume, *memory_.tip_proxy_W, tip_W);
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

// Finds the first intersection point: no collision at t-1, but one at t.
std::optional<Vec3> LineProxy::first_intersection(const Pose& X_WL) const {
  if (!memory_.X_WL) return std::nullopt;  // the first tick has no path to walk
  const auto hit = walk_to_collision(*scene_.volume, shaft_vertices(), *memory_.X_WL, X_WL, kWalk);
  if (!hit) return std::nullopt;
  return hit->intersection_W();
}

// Collision at t-1 already. The point-proxy rule takes IP from where it was toward the densest point; nothing
// if the shaft is free.
std::optional<Vec3> LineProxy::next_intersection(const Pose& X_WL) const {
  const Volume& volume = *scene_.volume;
  const ShaftProbe probe = densest_point(volume, shaft_vertices(), X_WL, *memory_.intersection_W);
  if (!(probe.density > volume.isovalue())) return std::nullopt;
  return move_point_proxy(volume, *memory_.intersection_W, probe.point_W);
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

// A burr's radius out from the tip's proxy, the shaft along (13).
Pose LineProxy::drawn_tool(const Pose& X_WL) const {
  const Volume& volume = *scene_.volume;
  Pose X_WT = X_WL;
  if (memory_.tip_proxy_W) {
    const auto u = surface_normal(volume, *memory_.tip_proxy_W);
    if (u) X_WT.position_mm += *u * scene_.tool.burr_radius_mm;
  }
  if (!memory_.intersection_W) return X_WT;
  const auto u = surface_normal(volume, *memory_.intersection_W);
  if (!u) return X_WT;
  const Vec3 offset_W = *memory_.intersection_W + *u * scene_.tool.shaft_radius_mm;  // eq. 12
  const Vec3 shaft_W = offset_W - X_WT.position_mm;                                  // eq. 13
  if (!(shaft_W.norm() > 1e-6)) return X_WT;
  X_WT.orientation = (smallest_rotation(shaft_direction(X_WL), shaft_W) * X_WL.orientation).normalized();
  return X_WT;
}

// Eq. 1 can divide by zero. The session replaces the wrench, which is then not finite, by zero; the state is
// dropped so that the next tick recovers.
void LineProxy::forget_what_is_not_finite() {
  const auto is_usable = [](const Vec3& vector) { return vector.norm() < kFarthest; };
  if (memory_.intersection_W && !is_usable(*memory_.intersection_W)) memory_.intersection_W.reset();
  if (!is_usable(memory_.arm_W)) memory_.arm_W.setZero();
  if (!is_usable(memory_.reaction_N)) memory_.reaction_N.setZero();
}

}  // namespace osteomill::line_proxy
