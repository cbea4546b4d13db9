#include "published/surface_points/surface_points.h"

#include <sstream>
#include <stdexcept>

#include "osteomill/haptics/sample_points.h"
#include "osteomill/volume/sampling.h"

#include "setting_warnings.h"

namespace osteomill::surface_points {

Vec3 spring_to_surface(const Volume& volume, const Vec3& vertex_W, const Vec3& centre_W) {
  const double vertex_density = density_at(volume.grid(), vertex_W);
  if (!(vertex_density > volume.isovalue())) return Vec3::Zero();
  const double centre_density = density_at(volume.grid(), centre_W);
  const double t = (vertex_density - volume.isovalue()) / (vertex_density - centre_density);
  return t * (centre_W - vertex_W);
}

std::vector<std::string> SurfacePoints::setting_warnings(const MillingTool& tool, const GridGeometry&) const {
  constexpr double kMinForce_N = 1;
  std::vector<std::string> warnings;
  add_stiffness_warning(warnings, "surface-points: a stiffness", settings_.stiffness_N_per_mm);
  // Sums over half the sphere's vertices, each half as far from the surface as from the centre.
  const double max_N = settings_.stiffness_N_per_mm * tool.burr_radius_mm / 8;
  if (max_N < kMinForce_N) {
    std::ostringstream line;
    line << "surface-points: a stiffness of " << settings_.stiffness_N_per_mm << " N/mm holds about " << max_N
         << " N on a burr of " << tool.burr_radius_mm << " mm; beyond that it falls through";
    warnings.push_back(line.str());
  }
  add_reads_warning(warnings, "surface-points: this number of slices and vertices",
                    2 * (settings_.sphere_vertices + settings_.slices * settings_.circle_vertices));
  return warnings;
}

void SurfacePoints::prepare(const AlgorithmInputs& inputs) {
  if (inputs.volume == nullptr) throw std::invalid_argument("surface-points: there is no volume");
  require_valid(inputs.tool);
  volume_ = inputs.volume;
  sphere_.vertex_offsets_T = sphere_vertices(inputs.tool, settings_.sphere_vertices);
  slices_.clear();
  for (const ShaftSlice& slice : slice_vertices(inputs.tool, settings_.slices, settings_.circle_vertices)) {
    VertexRing& ring = slices_.emplace_back(VertexRing{.centre_T = slice.centre_T});
    for (const Vec3& vertex : slice.vertices_T) ring.vertex_offsets_T.emplace_back(vertex - slice.centre_T);
  }
  reset();
}

void SurfacePoints::reset() noexcept {
  sphere_.force_W_N.setZero();
  for (VertexRing& slice : slices_) slice.force_W_N.setZero();
}

int SurfacePoints::sample_point_count() const {
  std::size_t count = sphere_.vertex_offsets_T.size();
  for (const VertexRing& slice : slices_) count += slice.vertex_offsets_T.size();
  return static_cast<int>(count);
}

void SurfacePoints::update(VertexRing& ring, const Pose& X_WD) const {
  const Vec3 centre_W = X_WD * ring.centre_T;
  Vec3 reach_mm = Vec3::Zero();
  ring.contacts = 0;
  for (const Vec3& vertex_offset_T : ring.vertex_offsets_T) {
    const Vec3 reach =
        spring_to_surface(*volume_, centre_W + X_WD.orientation * vertex_offset_T, centre_W);  // eq. 15
    if (!reach.isZero(0)) ++ring.contacts;
    reach_mm += reach;
  }
  // (17), (19): a centre in bone keeps the force of the previous step.
  if (is_bone_at(*volume_, centre_W)) return;
  // (14), (16), (18)
  ring.force_W_N =
      settings_.stiffness_N_per_mm / static_cast<double>(ring.vertex_offsets_T.size()) * reach_mm;
}

HapticStep SurfacePoints::step(const Pose& X_WD, double) noexcept {
  HapticStep result;
  result.X_WT = X_WD;
  update(sphere_, X_WD);
  result.contacts = sphere_.contacts;
  result.wrench.force_N = sphere_.force_W_N;
  result.burr_force_W_N = -sphere_.force_W_N;
  Vec3 torque_Nmm = Vec3::Zero();
  for (VertexRing& slice : slices_) {
    update(slice, X_WD);
    result.contacts += slice.contacts;
    torque_Nmm += (X_WD.orientation * slice.centre_T).cross(slice.force_W_N);
  }
  // (20), (21)
  if (!slices_.empty()) result.wrench.torque_Nmm += 1.0 / static_cast<double>(slices_.size()) * torque_Nmm;
  return result;
}

}  // namespace osteomill::surface_points
