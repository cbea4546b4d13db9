#include "published/line_proxy/line_proxy.h"

#include <algorithm>
#include <stdexcept>

#include "osteomill/haptics/sample_points.h"
#include "osteomill/volume/sampling.h"

#include "published/line_proxy/intersection.h"
#include "published/line_proxy/point_proxy.h"
#include "setting_warnings.h"

namespace osteomill::line_proxy {

namespace {

// Search distance for the surface if the tip is found deep in bone without having been seen to enter it
// (switched on there, or jumped there).
constexpr double kExitReach_mm = 5.0;
// Lengths in mm and forces in N beyond this count as not finite.
constexpr double kMaxNumber = 1e12;
// NUMBER_OF_TRANSLATION_STEPS and NUMBER_OF_ROTATION_STEPS of (3) and (4).
constexpr WalkSteps kWalk{10, 10};

}  // namespace

std::vector<std::string> LineProxy::setting_warnings(const MillingTool&, const GridGeometry&) const {
  std::vector<std::string> warnings;
  add_stiffness_warning(warnings, "line-proxy: a stiffness", settings_.stiffness_N_per_mm);
  // A tick in which the shaft first touches evaluates all vertices in each step of the walk.
  add_reads_warning(warnings, "line-proxy: this number of vertices",
                    (kWalk.translation + kWalk.rotation) * settings_.vertices);
  return warnings;
}

void LineProxy::prepare(const AlgorithmInputs& inputs) {
  if (inputs.volume == nullptr) throw std::invalid_argument("line-proxy: no volume");
  require_valid(inputs.tool);
  inputs_ = inputs;
  vertices_T_ = centreline_vertices(inputs.tool, settings_.vertices);
  reset();
}

HapticStep LineProxy::step(const Pose& X_WD, double) noexcept {
  const Vec3& tip_W = X_WD.position_mm;
  update_tip_proxy(tip_W);
  const Pose X_WL{state_.tip_proxy_W.value_or(tip_W), X_WD.orientation};
  update_intersection(X_WL);
  update_reaction(X_WL);
  state_.X_WL = X_WL;
  state_.device_tip_W = tip_W;
  HapticStep result;
  result.wrench.force_N = settings_.stiffness_N_per_mm * (X_WL.position_mm - tip_W);  // eq. 6
  result.wrench.torque_Nmm = state_.arm_W.cross(state_.reaction_N);                   // eq. 11
  if (state_.tip_proxy_W) result.burr_force_W_N = -result.wrench.force_N;
  const int on_shaft =
      state_.intersection_W ? std::max(1, count_in_bone(*inputs_.volume, shaft_vertices(), X_WL)) : 0;
  result.contacts = (state_.tip_proxy_W ? 1 : 0) + on_shaft;
  reset_if_not_finite();
  result.intersection_W = state_.intersection_W;
  result.X_WT = drawn_tool(X_WL);
  return result;
}

void LineProxy::update_tip_proxy(const Vec3& tip_W) {
  const Volume& volume = *inputs_.volume;
  if (!is_bone_at(volume, tip_W)) {
    state_.tip_proxy_W.reset();
    return;
  }
  if (!state_.tip_proxy_W) state_.tip_proxy_W = first_tip_proxy(tip_W);
  if (!state_.tip_proxy_W) return;
  state_.tip_proxy_W = move_point_proxy(volume, *state_.tip_proxy_W, tip_W);
  if (*state_.tip_proxy_W == tip_W) state_.tip_proxy_W.reset();
}

std::optional<Vec3> LineProxy::first_tip_proxy(const Vec3& tip_W) const {
  const Volume& volume = *inputs_.volume;
  if (state_.device_tip_W && !is_bone_at(volume, *state_.device_tip_W)) {
    return first_crossing(volume, *state_.device_tip_W, tip_W);
  }
  return nearest_exit(volume, tip_W, kExitReach_mm);
}

void LineProxy::update_intersection(const Pose& X_WL) {
  if (state_.intersection_W) {
    state_.intersection_W = next_intersection(X_WL);
  } else if (count_in_bone(*inputs_.volume, shaft_vertices(), X_WL) > 0) {
    state_.intersection_W = first_intersection(X_WL);
  }
}

// Finds the first intersection point: no collision at t-1, but one at t.
std::optional<Vec3> LineProxy::first_intersection(const Pose& X_WL) const {
  if (!state_.X_WL) return std::nullopt;  // the first tick has no path to walk
  const auto hit = walk_to_collision(*inputs_.volume, shaft_vertices(), *state_.X_WL, X_WL, kWalk);
  if (!hit) return std::nullopt;
  return hit->intersection_W();
}

// Collision at t-1 already: moves IP by the point-proxy rule towards the densest point. Returns nothing if
// the shaft is free.
std::optional<Vec3> LineProxy::next_intersection(const Pose& X_WL) const {
  const Volume& volume = *inputs_.volume;
  const ShaftProbe probe = densest_point(volume, shaft_vertices(), X_WL, *state_.intersection_W);
  if (!(probe.density > volume.isovalue())) return std::nullopt;
  return move_point_proxy(volume, *state_.intersection_W, probe.point_W);
}

void LineProxy::update_reaction(const Pose& X_WL) {
  state_.reaction_N.setZero();
  if (!state_.intersection_W) return;
  // The point on the device's shaft at the same distance from the tip as IP, and g, the error of orientation
  // alone.
  state_.arm_W = *state_.intersection_W - X_WL.position_mm;                             // eq. 7
  const Vec3 probe_W = state_.arm_W.norm() * shaft_direction(X_WL) + X_WL.position_mm;  // eq. 8
  const Vec3 g = *state_.intersection_W - probe_W;                                      // eq. 9
  state_.reaction_N = settings_.stiffness_N_per_mm * g;                                 // eq. 10
}

// Offsets the tip by the burr's radius from its proxy, and aligns the shaft with (13).
Pose LineProxy::drawn_tool(const Pose& X_WL) const {
  const Volume& volume = *inputs_.volume;
  Pose X_WT = X_WL;
  if (state_.tip_proxy_W) {
    const auto u = surface_normal(volume, *state_.tip_proxy_W);
    if (u) X_WT.position_mm += *u * inputs_.tool.burr_radius_mm;
  }
  if (!state_.intersection_W) return X_WT;
  const auto u = surface_normal(volume, *state_.intersection_W);
  if (!u) return X_WT;
  const Vec3 offset_W = *state_.intersection_W + *u * inputs_.tool.shaft_radius_mm;  // eq. 12
  const Vec3 shaft_W = offset_W - X_WT.position_mm;                                  // eq. 13
  if (!(shaft_W.norm() > 1e-6)) return X_WT;
  X_WT.orientation = (smallest_rotation(shaft_direction(X_WL), shaft_W) * X_WL.orientation).normalized();
  return X_WT;
}

// Eq. 1 can divide by zero. The session replaces the resulting wrench by zero; dropping the state lets the
// next tick recover.
void LineProxy::reset_if_not_finite() {
  const auto is_usable = [](const Vec3& vector) { return vector.norm() < kMaxNumber; };
  if (state_.intersection_W && !is_usable(*state_.intersection_W)) state_.intersection_W.reset();
  if (!is_usable(state_.arm_W)) state_.arm_W.setZero();
  if (!is_usable(state_.reaction_N)) state_.reaction_N.setZero();
}

}  // namespace osteomill::line_proxy
