#include "app/exercise_picture.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "osteomill/visual/bone_picture.h"
#include "osteomill/visual/clip_face.h"
#include "osteomill/volume/bone_densities.h"

namespace osteomill::app {

namespace {

// Returns the bone without the half in front of a plane. Keeps all structures, at a density that is drawn.
Volume cut_open(const PlacedExercise& placed, const Volume& scan, const BoneDensities& densities,
                const ClipPlane& front) {
  const GridGeometry& grid = scan.geometry();
  std::vector<float> cut;
  cut.reserve(grid.voxel_count());
  for_each(grid.all_voxels(), [&](const VoxelIndex& v) {
    const bool is_structure = std::ranges::any_of(
        placed.structures, [&](const PlacedStructure& one) { return one.voxels.contains(v); });
    const bool is_in_front = front.normal_W.dot(grid.world_from_voxel(v)) > front.offset_mm;
    cut.push_back(is_structure  ? static_cast<float>(densities.reference)
                  : is_in_front ? static_cast<float>(densities.surroundings)
                                : scan.grid()[v]);
  });
  Volume bone(DensityGrid(grid, std::move(cut)), scan.isovalue());
  bone.set_labels(colours_of(placed));
  return bone;
}

VoxelBox box_of(const VoxelSet& voxels) {
  VoxelBox box;
  voxels.for_each([&](const VoxelIndex& v) { box.include(v); });
  return box;
}

}  // namespace

Image exercise_picture(const PlacedExercise& placed, const Volume& scan, const PixelSize& size) {
  constexpr double kAround = 1.5, kAbove_rad = 0.7, kAside_rad = 0.35, kFieldOfView_rad = 0.3;
  const auto corners = corners_W(placed.scan, box_of(placed.target));
  const Vec3 middle_W = 0.5 * (corners.front() + corners.back());
  const double radius_mm = kAround * 0.5 * (corners.back() - corners.front()).norm();
  const Vec3& outward_W = placed.outward_W;
  const Vec3 up_W = std::abs(outward_W.z()) > 0.5 ? Vec3::UnitY() : Vec3::UnitZ();
  const Vec3 aside_W = up_W.cross(outward_W).normalized();
  const Vec3 front_W = aside_W.cross(outward_W);
  const Vec3 towards_W =
      std::sin(kAbove_rad) * outward_W +
      std::cos(kAbove_rad) * (std::cos(kAside_rad) * front_W + std::sin(kAside_rad) * aside_W);
  Camera camera = camera_on({middle_W, radius_mm}, -towards_W, outward_W);
  camera.field_of_view_rad = kFieldOfView_rad;
  camera.distance_mm = radius_mm / std::sin(0.5 * kFieldOfView_rad);
  const BoneDensities densities = estimate_densities(scan);
  const Volume bone = cut_open(placed, scan, densities, {front_W, front_W.dot(middle_W)});
  return bone_picture(bone, densities.reference, camera, size);
}

}  // namespace osteomill::app
