#include "osteomill/haptics/surface_points/surface_points.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "osteomill/haptics/surface_points/bone_nearby.h"
#include "osteomill/haptics/surface_points/ray_crossing.h"
#include "osteomill/tool/sample_points.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::surface_points {

namespace {

constexpr double kRateFilter_s = 2e-3;
// Of the sphere's contact, in proportion to its force (Hunt and Crossley 1975).
constexpr double kContactDamping_s_per_mm = 0.003;
// How deep in bone the held burr rests: bone that is denser than the isovalue lies up to a voxel behind the
// surface, and a burr that only touches sticks in its own hole.
constexpr double kBite_voxels = 0.3;
constexpr double kMaxBite_mm = 0.2;
// Circles that stand for a slice where the shaft is felt: an edge between two would slip through.
constexpr int kRingsPerSlice = 3;
// The share of a mean by force that is added to the mean by number of (20), in which an edge is as many times
// too soft as there are slices.
constexpr double kEdgeShare = 0.1;
// A held centre stays this far outside bone, so that no spring's walk begins inside by rounding.
constexpr double kClearOfSurface_mm = 0.01;
// The held tool's bite and what it may lag behind by.
constexpr double kHeldToolMayOverlap_mm = kMaxBite_mm + 0.15;

}  // namespace

SurfacePoints::SurfacePoints(const Settings& settings) : settings_(settings) {
  require_valid(settings_);
}

void SurfacePoints::prepare(const Scene& scene) {
  if (scene.volume == nullptr) throw std::invalid_argument("surface-points: a scene without a volume");
  require_valid(scene.tool);
  volume_ = scene.volume;
  tool_ = scene.tool;
  sphere_ = Fan{};
  sphere_.arms_T = sphere_vertices(tool_, settings_.sphere_vertices);
  sphere_.longest_arm_mm = tool_.burr_radius_mm;
  prepare_shaft();
  const double bite_mm = std::min(kBite_voxels * volume_->geometry().spacing_mm.minCoeff(), kMaxBite_mm);
  held_tool_.prepare(*volume_, tool_, rings(), std::min(bite_mm, 0.5 * tool_.burr_radius_mm));
  reset();
}

int SurfacePoints::rings() const {
  return settings_.slices * (settings_.shaft_force ? kRingsPerSlice : 1);
}

void SurfacePoints::prepare_shaft() {
  rings_.clear();
  end_.reset();
  for (const ShaftSlice& ring : slice_vertices(tool_, rings(), settings_.circle_vertices)) {
    Fan fan;
    fan.is_ring = true;
    fan.longest_arm_mm = tool_.shaft_radius_mm;
    fan.centre_T = ring.centre_T;
    for (const Vec3& vertex : ring.vertices_T) fan.arms_T.emplace_back(vertex - ring.centre_T);
    rings_.push_back(std::move(fan));
  }
  if (rings_.empty()) return;
  ring_spacing_mm_ = (tool_.shaft_length_mm - shaft_start_mm(tool_)) / rings();
  if (!settings_.shaft_force) return;
  // The middle of the end face and its rim, about a centre a radius within.
  const Vec3 inward_T(0, 0, tool_.shaft_radius_mm);
  end_ = Fan{};
  end_->centre_T = Vec3(0, 0, tool_.shaft_length_mm) - inward_T;
  end_->arms_T.push_back(inward_T);
  for (const Vec3& arm_T : rings_.front().arms_T) end_->arms_T.emplace_back(inward_T + arm_T);
  end_->longest_arm_mm = end_->arms_T.back().norm();
}

void SurfacePoints::reset() {
  sphere_.force_W_N.setZero();
  for (Fan& ring : rings_) ring.force_W_N.setZero();
  if (end_) end_->force_W_N.setZero();
  held_tool_.reset();
  burr_.reset();
  last_overlap_W_mm_.setZero();
  overlap_rate_W_mm_s_.setZero();
}

int SurfacePoints::sample_point_count() const {
  std::size_t count = sphere_.arms_T.size();
  for (const Fan& ring : rings_) count += ring.arms_T.size();
  if (end_) count += end_->arms_T.size();
  return static_cast<int>(count);
}

bool SurfacePoints::in_bone(const Vec3& point_W) const {
  return density_at(volume_->grid(), point_W) > volume_->isovalue();
}

Vec3 SurfacePoints::reach_of(const Vec3& vertex_W, const Vec3& centre_W, double free_mm) const {
  if (settings_.reach == Reach::to_first_bone) return marched_spring(*volume_, vertex_W, centre_W, free_mm);
  const Vec3 reach = interpolated_spring(*volume_, vertex_W, centre_W);
  if (settings_.reach == Reach::to_surface || reach.isZero(0)) return reach;
  return centre_W - vertex_W - reach;
}

// The sum of the springs of a fan whose centre lies at `centre_W`, `free_mm` or more from bone, with the tool
// turned as it is.
Vec3 SurfacePoints::sum_of_reaches(Fan& fan, const Quat& orientation, const Vec3& centre_W,
                                   double free_mm) const {
  const Vec3 axis_W = fan.is_ring ? Vec3(orientation * Vec3::UnitZ()) : Vec3(Vec3::Zero());
  if (!bone_near_disc(*volume_, centre_W, axis_W, fan.longest_arm_mm)) return Vec3::Zero();
  // A vertex that has come out behind a thin wall must not let go.
  const bool through_walls = settings_.reach == Reach::to_first_bone && !fan.is_ring;
  Vec3 reach_mm = Vec3::Zero();
  fan.deepest_mm = 0;
  for (std::size_t n = 0; n < fan.arms_T.size(); ++n) {
    const Vec3& arm_T = fan.arms_T[n];
    const Vec3 vertex_W = centre_W + orientation * arm_T;
    if (!through_walls && !in_bone(vertex_W)) continue;
    const Vec3 reach = reach_of(vertex_W, centre_W, free_mm);
    if (reach.isZero(0)) continue;
    ++fan.contacts;
    reach_mm += reach;
    if (const double depth_mm = reach.norm(); depth_mm > fan.deepest_mm) {
      fan.deepest_mm = depth_mm;
      fan.deepest_arm = n;
    }
  }
  return reach_mm;
}

// How far about its centre the held tool's burr or ring is known to be free of bone.
double SurfacePoints::free_about_held_mm(const Fan& fan) const {
  return fan.arms_T.front().norm() - kHeldToolMayOverlap_mm;
}

// As far as a centre gets on the straight way from the held tool's to the device's; nothing where not even
// the held tool's is free.
std::optional<Vec3> SurfacePoints::held_centre(const Fan& fan, const Pose& X_WD, const Pose& X_WH) const {
  const Vec3 device_W = X_WD * fan.centre_T;
  const Vec3 held_W = X_WH * fan.centre_T;
  const Vec3 way = device_W - held_W;
  // Within what the held tool keeps free no search is needed.
  if (way.norm() < free_about_held_mm(fan) && !in_bone(device_W)) return device_W;
  if (!bone_near_disc(*volume_, 0.5 * (held_W + device_W), Vec3::Zero(), 0.5 * way.norm())) return device_W;
  if (in_bone(held_W)) return std::nullopt;
  const std::optional<double> share = share_to_bone(*volume_, held_W, device_W, free_about_held_mm(fan));
  if (!share) return device_W;
  return Vec3(held_W + std::max(0.0, *share - kClearOfSurface_mm / way.norm()) * way);
}

void SurfacePoints::update(Fan& fan, const Pose& X_WD, const Pose& X_WH) const {
  fan.contacts = 0;
  const Vec3 device_W = X_WD * fan.centre_T;
  std::optional<Vec3> centre_W = device_W;
  fan.held_back_W_mm.setZero();
  if (settings_.hold_tool) {
    centre_W = held_centre(fan, X_WD, X_WH);
    if (centre_W) fan.held_back_W_mm = *centre_W - device_W;
  } else if (in_bone(device_W)) {
    centre_W.reset();
  }
  double free_mm = 0;
  if (settings_.hold_tool && centre_W) {
    free_mm = free_about_held_mm(fan) - (*centre_W - X_WH * fan.centre_T).norm();
  }
  const Vec3 reach_mm = sum_of_reaches(fan, X_WD.orientation, centre_W.value_or(device_W), free_mm);
  // (14), (16), (18)
  if (centre_W) {
    fan.force_W_N = settings_.stiffness_N_per_mm / static_cast<double>(fan.arms_T.size()) * reach_mm;
  } else if (settings_.hold_tool) {
    fan.force_W_N.setZero();
  }
  // Else (17), (19): a centre in bone keeps the force of the step before.
  const bool is_pushed = settings_.shaft_force && fan.is_ring && centre_W && fan.contacts > 0;
  fan.pushed_at_mm = is_pushed ? pushed_at_mm(fan, X_WD.orientation, *centre_W, free_mm) : 0.0;
}

// The middle of what the deepest vertex and two beside it along the shaft are pushed back.
double SurfacePoints::pushed_at_mm(const Fan& ring, const Quat& orientation, const Vec3& centre_W,
                                   double free_mm) const {
  const Vec3 arm_W = orientation * ring.arms_T[ring.deepest_arm];
  const Vec3 aside_W = ring_spacing_mm_ / 3 * (orientation * Vec3::UnitZ());
  const auto depth_mm = [&](const Vec3& from_W) {
    return marched_spring(*volume_, from_W + arm_W, from_W, free_mm).norm();
  };
  const double below = depth_mm(centre_W - aside_W);
  const double above = depth_mm(centre_W + aside_W);
  const double sum = below + ring.deepest_mm + above;
  return sum > 0 ? ring_spacing_mm_ / 3 * (above - below) / sum : 0.0;
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

Vec3 SurfacePoints::damped(const Vec3& force_N, const Vec3& overlap_W_mm, double dt_s) {
  const Vec3 rate = dt_s > 0 ? Vec3((overlap_W_mm - last_overlap_W_mm_) / dt_s) : Vec3(Vec3::Zero());
  last_overlap_W_mm_ = overlap_W_mm;
  overlap_rate_W_mm_s_ += dt_s / (dt_s + kRateFilter_s) * (rate - overlap_rate_W_mm_s_);
  const double force = force_N.norm();
  if (force == 0) return force_N;
  const double sinking_mm_s = -overlap_rate_W_mm_s_.dot(force_N) / force;
  return std::clamp(1 + kContactDamping_s_per_mm * sinking_mm_s, 0.0, 2.0) * force_N;
}

SurfacePoints::ShaftSum SurfacePoints::shaft_sum(const Pose& X_WD, const Pose& X_WH) {
  ShaftSum sum;
  Wrench by_force;
  double forces_N = 0;
  for (Fan& ring : rings_) {
    update(ring, X_WD, X_WH);
    sum.contacts += ring.contacts;
    const Vec3 lever_mm = X_WD.orientation * (ring.centre_T + ring.pushed_at_mm * Vec3::UnitZ());
    const Vec3 force_N = ring.force_W_N + 0.5 * settings_.stiffness_N_per_mm * ring.held_back_W_mm;
    sum.mean.force_N += force_N;
    sum.mean.torque_Nmm += lever_mm.cross(force_N);
    const double weight_N = ring.force_W_N.norm();
    by_force.force_N += weight_N * ring.force_W_N;
    by_force.torque_Nmm += weight_N * lever_mm.cross(ring.force_W_N);
    forces_N += weight_N;
  }
  // (20), (21), and the share that an edge has beside them.
  const double each = rings_.empty() ? 0.0 : 1.0 / static_cast<double>(rings_.size());
  const double beside = forces_N > 0 ? (settings_.shaft_force ? kEdgeShare : 0.0) / forces_N : 0.0;
  sum.mean.force_N = each * sum.mean.force_N + beside * by_force.force_N;
  sum.mean.torque_Nmm = each * sum.mean.torque_Nmm + beside * by_force.torque_Nmm;
  if (end_) add_end(X_WD, X_WH, sum);
  return sum;
}

// The end stands in bone as a body of its own, as the burr does.
void SurfacePoints::add_end(const Pose& X_WD, const Pose& X_WH, ShaftSum& sum) {
  update(*end_, X_WD, X_WH);
  sum.contacts += end_->contacts;
  const double share = std::min(1.0, settings_.max_stiffness_N_per_mm / settings_.stiffness_N_per_mm);
  const Vec3 force_N = share * end_->force_W_N + beyond_N_per_mm() * end_->held_back_W_mm;
  sum.mean.force_N += force_N;
  sum.mean.torque_Nmm += (X_WD.orientation * end_->centre_T).cross(force_N);
}

// Of the spring to a centre that cannot follow the device.
double SurfacePoints::beyond_N_per_mm() const {
  return std::min(settings_.max_stiffness_N_per_mm, 0.5 * settings_.stiffness_N_per_mm);
}

HapticStep SurfacePoints::step(const Pose& X_WD, double dt_s) {
  HapticStep result;
  const Pose X_WH = settings_.hold_tool ? held_tool_.follow(X_WD) : X_WD;
  update(sphere_, X_WD, X_WH);
  const ShaftSum shaft = shaft_sum(X_WD, X_WH);
  result.contacts = sphere_.contacts + shaft.contacts;
  result.wrench.torque_Nmm = shaft.mean.torque_Nmm;
  result.wrench.force_N = soften(sphere_.force_W_N) + beyond_N_per_mm() * sphere_.held_back_W_mm;
  result.X_WT = X_WH;
  if (settings_.hold_tool) {
    const Vec3 overlap_W_mm = X_WD.position_mm - X_WH.position_mm;
    result.wrench.force_N = damped(result.wrench.force_N, overlap_W_mm, dt_s);
  }
  result.burr_force_W_N = -result.wrench.force_N;
  if (settings_.hold_tool &&
      !burr_.presses(*volume_, tool_.burr_radius_mm, X_WH.position_mm, result.burr_force_W_N, dt_s)) {
    result.burr_force_W_N.setZero();
  }
  if (settings_.shaft_force) result.wrench.force_N += shaft.mean.force_N;
  return result;
}

double interpolated_share(double vertex_density, double free_density, double isovalue) {
  return (vertex_density - isovalue) / (vertex_density - free_density);
}

Vec3 interpolated_spring(const Volume& volume, const Vec3& vertex_W, const Vec3& free_W) {
  const double vertex_density = density_at(volume.grid(), vertex_W);
  if (!(vertex_density > volume.isovalue())) return Vec3::Zero();
  const double free_density = density_at(volume.grid(), free_W);
  return interpolated_share(vertex_density, free_density, volume.isovalue()) * (free_W - vertex_W);
}

Vec3 marched_spring(const Volume& volume, const Vec3& vertex_W, const Vec3& free_W, double known_free_mm) {
  const bool starts_in_bone = known_free_mm <= 0 && density_at(volume.grid(), free_W) > volume.isovalue();
  if (starts_in_bone) return free_W - vertex_W;
  const std::optional<double> share = share_to_bone(volume, free_W, vertex_W, known_free_mm);
  return share ? Vec3((1 - *share) * (free_W - vertex_W)) : Vec3(Vec3::Zero());
}

}  // namespace osteomill::surface_points
