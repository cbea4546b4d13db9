#include "app/simulate/scene_of.h"

#include <algorithm>

#include "app/simulate/cuts.h"

namespace osteomill::app {

namespace {

constexpr double kWidestWhole_mm = 25;
constexpr double kAroundEntry_mm = 16;
constexpr double kApart_mm = 0.03;
constexpr double kApart_rad = 0.01;

}  // namespace

Sphere bounds_of_bone(const DensityGrid& grid, double isovalue) {
  const GridGeometry& geometry = grid.geometry();
  VoxelBox box;
  std::size_t n = 0;
  for (int k = 0; k < geometry.dims[2]; ++k) {
    for (int j = 0; j < geometry.dims[1]; ++j) {
      for (int i = 0; i < geometry.dims[0]; ++i) {
        if (static_cast<double>(grid.densities()[n++]) > isovalue) box.include({i, j, k});
      }
    }
  }
  if (box.empty()) box = geometry.all_voxels();
  const Vec3 first = geometry.world_from_voxel(box.first);
  const Vec3 last = geometry.world_from_voxel(box.last);
  return {0.5 * (first + last), std::max(0.5 * (last - first).norm(), 1.0)};
}

Camera camera_on_entry(const MillingEntry& entry, const Sphere& bounds) {
  const Vec3 sideways = entry.direction_W.cross(entry.lateral_W);
  const Vec3 direction = 0.75 * entry.direction_W + 0.6 * sideways + 0.2 * entry.lateral_W;
  const bool whole = bounds.radius_mm < kWidestWhole_mm;
  const Sphere shown = whole ? Sphere{0.5 * (bounds.centre_W + entry.point_W), 0.9 * bounds.radius_mm}
                             : Sphere{entry.point_W, kAroundEntry_mm};
  return camera_on(shown, direction, -entry.direction_W);
}

ViewScene scene_of(const ViewState& view, Simulation& simulation) {
  const TickRecord& record = simulation.milling.state().record;
  ViewScene scene;
  scene.camera = view.camera;
  scene.bounds = view.bounds;
  scene.tool = simulation.milling.setup().tool;
  scene.X_WT = record.X_WT;
  // Where both are the same the ghost would only tint the tool.
  const double apart_mm = (record.X_WD.position_mm - record.X_WT.position_mm).norm();
  const double apart_rad = record.X_WD.orientation.angularDistance(record.X_WT.orientation);
  if (view.ghost && (apart_mm > kApart_mm || apart_rad > kApart_rad)) scene.X_WD = record.X_WD;
  if (view.arrows) scene.wrench = record.wrench;
  scene.isovalue = simulation.milling.isovalue();
  scene.reference_density = simulation.milling.densities().reference;
  for (std::size_t n = 0; n < view.cuts.size(); ++n) {
    if (view.cuts[n].on) scene.cuts[n] = plane_of(view.cuts[n]);
  }
  return scene;
}

}  // namespace osteomill::app
