#include "app/simulate/scene_of.h"

#include <algorithm>

namespace osteomill::app {

namespace {

constexpr double kWidestWhole_mm = 25;
constexpr double kAroundEntry_mm = 16;

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
  const TickRecord& record = simulation.state().record;
  ViewScene scene;
  scene.camera = view.camera;
  scene.bounds = view.bounds;
  scene.tool = simulation.settings().tool;
  scene.X_WT = record.X_WT;
  if (view.ghost) scene.X_WD = record.X_WD;
  if (view.arrows) scene.wrench = record.wrench;
  scene.isovalue = simulation.isovalue();
  scene.reference_density = simulation.densities().reference;
  for (std::size_t n = 0; n < view.cuts.size(); ++n) {
    const ViewState::Cut& cut = view.cuts[n];
    const double side = cut.other_side ? -1 : 1;
    if (cut.on) scene.cuts[n] = CutPlane{side * cut.normal_W, side * static_cast<double>(cut.offset_mm)};
  }
  return scene;
}

}  // namespace osteomill::app
