#include "osteomill/haptics/surface_points/surface_points.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "osteomill/haptics/barrier_shell/barrier_shell.h"
#include "osteomill/haptics/bone_points/cores.h"
#include "osteomill/haptics/surface_points/vertex_springs.h"
#include "osteomill/tool/sample_points.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::surface_points {

namespace {

constexpr double kRateFilter_s = 2e-3;
// In proportion to the contact's force (Hunt and Crossley 1975).
constexpr double kContactDamping_s_per_mm = 0.003;
// Of the held tool's coupling against k, and the share of it that is felt from the first touch on: an edge
// between two slices, or the shaft's flat end, would not be felt else.
constexpr double kCouplingShare = 0.1;
constexpr double kAlwaysCoupled = 0.3;
// Of what the held tool's burr presses with, what is paid for at most: its wrench may all but vanish.
constexpr double kMostPressed = 2;
// Bone's points lie so far apart that bone reaches a little into what the held tool keeps free.
constexpr double kBetweenPoints_mm = 0.03;
// How fast a spring lengthens or shortens where the bone changes under its vertex.
constexpr double kGive_mm_s = 15;

}  // namespace

SurfacePoints::SurfacePoints(const Settings& settings) : settings_(settings) {}

void SurfacePoints::prepare(const Scene& scene) {
  if (scene.volume == nullptr) throw std::invalid_argument("surface-points: a scene without a volume");
  require_valid(scene.tool);
  volume_ = scene.volume;
  tool_ = scene.tool;
  sphere_ = {};
  sphere_.radius_mm = tool_.burr_radius_mm;
  sphere_.arms_T = sphere_vertices(tool_, settings_.sphere_vertices);
  slices_.clear();
  for (const ShaftSlice& slice : slice_vertices(tool_, settings_.slices, settings_.circle_vertices)) {
    Fan& fan = slices_.emplace_back(Fan{true, slice.centre_T, tool_.shaft_radius_mm});
    for (const Vec3& vertex : slice.vertices_T) fan.arms_T.emplace_back(vertex - slice.centre_T);
  }
  if (settings_.hold_tool) {
    auto held = barrier_shell::Settings::defaults();
    const double stiffness =
        std::min(settings_.max_stiffness_N_per_mm, kCouplingShare * settings_.stiffness_N_per_mm);
    held.torsional_stiffness_Nmm_per_rad *= stiffness / held.translational_stiffness_N_per_mm;
    held.translational_stiffness_N_per_mm = stiffness;
    held_tool_ = std::make_unique<barrier_shell::BarrierShell>(held);
    held_tool_->prepare(scene);
    inset_mm_ = inset_within(tool_, held.rounding_mm) + kBetweenPoints_mm;
  }
  reset();
}

void SurfacePoints::volume_changed(const VolumeChange& change) {
  if (held_tool_) held_tool_->volume_changed(change);
}

void SurfacePoints::reset() {
  const auto forget = [](Fan& fan) {
    fan.depths_mm.assign(fan.arms_T.size(), 0);
    fan.force_W_N.setZero();
  };
  forget(sphere_);
  std::for_each(slices_.begin(), slices_.end(), forget);
  if (held_tool_) held_tool_->reset();
  X_WV_before_.reset();
  last_overlap_W_mm_.setZero();
  overlap_rate_W_mm_s_.setZero();
}

int SurfacePoints::sample_point_count() const {
  std::size_t count = sphere_.arms_T.size();
  for (const Fan& slice : slices_) count += slice.arms_T.size();
  return static_cast<int>(count);
}

Vec3 SurfacePoints::reach_of(const Vec3& vertex_W, const Vec3& centre_W, double free_mm) const {
  if (settings_.reach == Reach::to_first_bone) return marched_spring(*volume_, vertex_W, centre_W, free_mm);
  const Vec3 reach = interpolated_spring(*volume_, vertex_W, centre_W);
  if (settings_.reach == Reach::to_surface || reach.isZero(0)) return reach;
  return centre_W - vertex_W - reach;
}

// The sum of the springs of a fan whose centre lies at `centre_W`.
Vec3 SurfacePoints::sum_of_reaches(Fan& fan, const Stand& at, const Vec3& centre_W, bool inside) const {
  const Quat& orientation = at.X_WV.orientation;
  const Vec3 axis_W = fan.is_slice ? Vec3(orientation * Vec3::UnitZ()) : Vec3(Vec3::Zero());
  const bool near = bone_near_disc(*volume_, centre_W, axis_W, fan.radius_mm);
  fan.contacts = 0;
  if (!near && fan.force_W_N.isZero(0)) return Vec3::Zero();
  // A vertex that has come out behind a thin wall must not let go.
  const bool through_walls = settings_.reach == Reach::to_first_bone && !fan.is_slice;
  const double free_mm = held_tool_ && !inside
                             ? fan.radius_mm - inset_mm_ - (centre_W - at.held.X_WT * fan.centre_T).norm()
                             : 0.0;
  // A spring follows its vertex at once; where bone comes or goes under it, by the give.
  const double may_mm = at.give_mm + at.move.translation_mm.norm() +
                        at.move.rotation_rad.norm() * (fan.centre_T.norm() + fan.radius_mm);
  Vec3 reach_mm = Vec3::Zero();
  for (std::size_t n = 0; n < fan.arms_T.size(); ++n) {
    const Vec3 arm_W = orientation * fan.arms_T[n];
    const Vec3 vertex_W = centre_W + arm_W;
    Vec3 reach = Vec3::Zero();
    if (near && (through_walls || is_bone_at(*volume_, vertex_W)))
      reach = reach_of(vertex_W, centre_W, free_mm);
    if (!reach.isZero(0)) ++fan.contacts;
    if (held_tool_) {
      double& depth_mm = fan.depths_mm[n];
      depth_mm = std::clamp(inside ? 0 : reach.norm(), depth_mm - may_mm, depth_mm + may_mm);
      reach = -depth_mm / fan.radius_mm * arm_W;
    }
    reach_mm += reach;
  }
  return reach_mm;
}

void SurfacePoints::update(Fan& fan, const Stand& at) const {
  const Vec3 centre_W = at.X_WV * fan.centre_T;
  const bool inside = is_bone_at(*volume_, centre_W);
  const Vec3 reach_mm = sum_of_reaches(fan, at, centre_W, inside);
  // (17), (19): a centre in bone keeps the force of the step before.
  if (inside && !held_tool_) return;
  // (14), (16), (18)
  fan.force_W_N = settings_.stiffness_N_per_mm / static_cast<double>(fan.arms_T.size()) * reach_mm;
}

// Summed over the whole sphere, (14) gives k d^2 / (4 r) on a plane at depth d: its slope k d / (2 r) is
// sqrt(k F / r) at force F.
Vec3 SurfacePoints::soften(const Vec3& force_N) const {
  const double k = settings_.stiffness_N_per_mm;
  const double r = tool_.burr_radius_mm;
  const double slope = settings_.max_stiffness_N_per_mm;
  const double force = force_N.norm();
  if (force * k <= slope * slope * r) return force_N;
  const double force_at_slope = slope * slope * r / k;
  const double depth_beyond = 2 * std::sqrt(r / k) * (std::sqrt(force) - std::sqrt(force_at_slope));
  return (force_at_slope + slope * depth_beyond) / force * force_N;
}

Vec3 SurfacePoints::damping_N(double force_N, const Vec3& overlap_W_mm, double dt_s) {
  const Vec3 rate = dt_s > 0 ? Vec3((overlap_W_mm - last_overlap_W_mm_) / dt_s) : Vec3(Vec3::Zero());
  last_overlap_W_mm_ = overlap_W_mm;
  overlap_rate_W_mm_s_ += dt_s / (dt_s + kRateFilter_s) * (rate - overlap_rate_W_mm_s_);
  const Vec3 share = kContactDamping_s_per_mm * overlap_rate_W_mm_s_;
  return -force_N / std::max(1.0, share.norm()) * share;
}

// The vertices go with the device, but no farther ahead of the held tool than their centres stay in what it
// keeps free of bone: the rest of the way is left to its coupling.
SurfacePoints::Stand SurfacePoints::stand(const Pose& X_WD, double dt_s) {
  Stand at{X_WD};
  if (!held_tool_) return at;
  at.held = held_tool_->step(X_WD, dt_s);
  const Pose& X_WH = at.held.X_WT;
  const Vec3 end_T(0, 0, tool_.shaft_length_mm);
  const double way_mm =
      std::max((X_WD.position_mm - X_WH.position_mm).norm(), (X_WD * end_T - X_WH * end_T).norm());
  const double room_mm = std::max(0.0, std::min(tool_.burr_radius_mm, tool_.shaft_radius_mm) - inset_mm_);
  double ahead = 1;
  if (way_mm > room_mm) {
    ahead = room_mm / way_mm;
    at.X_WV = moved(X_WH, ahead * move_between(X_WH, X_WD));
  }
  at.coupled = 1 - (1 - kAlwaysCoupled) * ahead;
  at.move = move_between(X_WV_before_.value_or(at.X_WV), at.X_WV);
  at.give_mm = kGive_mm_s * std::max(0.0, dt_s);
  X_WV_before_ = at.X_WV;
  return at;
}

HapticStep SurfacePoints::step(const Pose& X_WD, double dt_s) {
  const Stand at = stand(X_WD, dt_s);
  HapticStep result;
  result.X_WT = held_tool_ ? at.held.X_WT : X_WD;
  result.owed_bricks = at.held.owed_bricks;
  update(sphere_, at);
  result.contacts = sphere_.contacts;
  // (20), (21)
  Wrench shaft;
  const double each = 1.0 / static_cast<double>(slices_.size());
  for (Fan& slice : slices_) {
    update(slice, at);
    result.contacts += slice.contacts;
    shaft.force_N += slice.force_W_N;
    shaft.torque_Nmm += (at.X_WV.orientation * slice.centre_T).cross(slice.force_W_N);
  }
  result.wrench.force_N = soften(sphere_.force_W_N);
  result.burr_force_W_N = -result.wrench.force_N;
  if (held_tool_) {
    result.wrench = result.wrench + at.coupled * at.held.wrench;
    result.wrench.force_N +=
        damping_N(result.wrench.force_N.norm(), X_WD.position_mm - result.X_WT.position_mm, dt_s);
    // Of what the hand gives, a wall or the shaft may hold a part: the held tool tells what the burr presses
    // on.
    const double felt = result.wrench.force_N.norm() / at.held.wrench.force_N.norm();
    result.burr_force_W_N = std::min(kMostPressed, felt) * at.held.burr_force_W_N;
  }
  if (slices_.empty()) return result;
  result.wrench.torque_Nmm += each * shaft.torque_Nmm;
  if (settings_.shaft_force) result.wrench.force_N += each * shaft.force_N;
  return result;
}

}  // namespace osteomill::surface_points
