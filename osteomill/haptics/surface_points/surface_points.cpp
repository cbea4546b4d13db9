#include "osteomill/haptics/surface_points/surface_points.h"

#include <stdexcept>

#include "osteomill/haptics/surface_points/vertex_spring.h"
#include "osteomill/tool/sample_points.h"
#include "osteomill/volume/sampling.h"

namespace osteomill {

SurfacePoints::SurfacePoints(const SurfacePointsSettings& settings) : settings_(settings) {
  require_valid(settings_);
}

void SurfacePoints::prepare(const Scene& scene) {
  if (scene.volume == nullptr) throw std::invalid_argument("surface-points: a scene without a volume");
  require_valid(scene.tool);
  volume_ = scene.volume;
  const auto on_sphere = sphere_vertices(scene.tool);
  sphere_ = Fan{};
  sphere_.vertices_T.assign(on_sphere.begin(), on_sphere.end());
  slices_.clear();
  for (const ShaftSlice& slice : slice_vertices(scene.tool, settings_.slices)) {
    slices_.push_back({slice.centre_T, {slice.vertices_T.begin(), slice.vertices_T.end()}, Vec3::Zero()});
  }
}

void SurfacePoints::reset() {
  sphere_.held_force_W_N.setZero();
  for (Fan& slice : slices_) slice.held_force_W_N.setZero();
}

int SurfacePoints::sample_point_count() const {
  std::size_t count = sphere_.vertices_T.size();
  for (const Fan& slice : slices_) count += slice.vertices_T.size();
  return static_cast<int>(count);
}

// Brings a fan's force up to date and says how many of its vertices collide.
int SurfacePoints::update_force(Fan& fan, const Pose& X_WD) const {
  const Vec3 centre_W = X_WD * fan.centre_T;
  const bool centre_in_bone = density_at(volume_->grid(), centre_W) > volume_->isovalue();
  int contacts = 0;
  Vec3 reach_mm = Vec3::Zero();
  for (const Vec3& vertex_T : fan.vertices_T) {
    const Vec3 vertex_W = X_WD * vertex_T;
    if (!(density_at(volume_->grid(), vertex_W) > volume_->isovalue())) continue;
    ++contacts;
    if (centre_in_bone) continue;
    reach_mm += settings_.march_to_surface ? marched_spring(*volume_, vertex_W, centre_W)
                                           : interpolated_spring(*volume_, vertex_W, centre_W);
  }
  // (17), (19): a centre in bone keeps the force of the step before.
  if (centre_in_bone) return contacts;
  // (14), (16), (18)
  fan.held_force_W_N = settings_.stiffness_N_per_mm / static_cast<double>(fan.vertices_T.size()) * reach_mm;
  return contacts;
}

HapticStep SurfacePoints::step(const Pose& X_WD, double /*dt_s*/) {
  HapticStep result;
  result.X_WT = X_WD;
  result.contacts = update_force(sphere_, X_WD);
  result.burr_force_N = sphere_.held_force_W_N.norm();
  Vec3 shaft_force_N = Vec3::Zero();
  Vec3 torque_Nmm = Vec3::Zero();
  for (Fan& slice : slices_) {
    result.contacts += update_force(slice, X_WD);
    shaft_force_N += slice.held_force_W_N;
    torque_Nmm += (X_WD.orientation * slice.centre_T).cross(slice.held_force_W_N);
  }
  // (20), (21)
  const double share = slices_.empty() ? 0.0 : 1.0 / static_cast<double>(slices_.size());
  result.wrench.torque_Nmm = share * torque_Nmm;
  result.wrench.force_N = sphere_.held_force_W_N;
  if (settings_.shaft_force) result.wrench.force_N += share * shaft_force_N;
  return result;
}

}  // namespace osteomill
