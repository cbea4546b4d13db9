#include "osteomill/study/probe_bones.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace osteomill {

namespace {

// Fills a grid of cubic voxels below a surface; `height_mm` is the height of a point (W) above it.
template <typename Height>
Volume bone_below(const GridGeometry& geometry, const Height& height_mm) {
  constexpr double kEdge_voxels = 2;
  constexpr float kIsovalue = 500;
  std::vector<float> densities;
  densities.reserve(geometry.voxel_count());
  for_each(geometry.all_voxels(), [&](const VoxelIndex& voxel) {
    const double voxels = height_mm(geometry.world_from_voxel(voxel)) / geometry.spacing_mm.x();
    densities.push_back(
        static_cast<float>(2 * kIsovalue * std::clamp(0.5 - voxels / kEdge_voxels, 0.0, 1.0)));
  });
  return Volume(DensityGrid(geometry, std::move(densities)), kIsovalue);
}

}  // namespace

Volume flat_wall(const MillingTool& tool) {
  constexpr double kMargin_mm = 0.5, kAbove_mm = 1;
  constexpr double kVoxelsToTheRadius = 12, kMinVoxel_mm = 0.05, kMaxVoxel_mm = 0.5;
  const double spacing_mm = std::clamp(tool.burr_radius_mm / kVoxelsToTheRadius, kMinVoxel_mm, kMaxVoxel_mm);
  // Deeper than any press, even for an algorithm that feels only the burr's centre.
  const double thick_mm = tool.burr_radius_mm + 4;
  const double half_mm = tool.burr_radius_mm + kMargin_mm;
  GridGeometry geometry;
  geometry.dims[0] = geometry.dims[1] = 1 + 2 * static_cast<int>(std::ceil(half_mm / spacing_mm));
  geometry.dims[2] = 1 + static_cast<int>(std::ceil((thick_mm + kAbove_mm) / spacing_mm));
  geometry.spacing_mm = Vec3::Constant(spacing_mm);
  // Places the surface between two layers, off centre, so that no voxel is exactly on it.
  geometry.origin_mm = {-0.5 * (geometry.dims[0] - 1) * spacing_mm,
                        -0.5 * (geometry.dims[1] - 1) * spacing_mm,
                        -(std::floor(thick_mm / spacing_mm) + 0.3) * spacing_mm};
  return bone_below(geometry, [](const Vec3& p) { return p.z(); });
}

Volume sharp_edge(const MillingTool& tool) {
  constexpr double kVoxelsToTheRadius = 5, kHalfInRadii = 4;
  const double spacing_mm = tool.shaft_radius_mm / kVoxelsToTheRadius;
  GridGeometry geometry;
  geometry.dims.fill(1 + 2 * static_cast<int>(kVoxelsToTheRadius * kHalfInRadii));
  geometry.spacing_mm = Vec3::Constant(spacing_mm);
  // No voxel is exactly on the edge.
  geometry.origin_mm = Vec3::Constant(-(kVoxelsToTheRadius * kHalfInRadii + 0.3) * spacing_mm);
  return bone_below(geometry, [](const Vec3& p) { return (p.z() + std::abs(p.x())) / std::numbers::sqrt2; });
}

}  // namespace osteomill
