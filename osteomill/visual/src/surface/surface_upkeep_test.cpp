#include "osteomill/visual/surface_upkeep.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "osteomill/volume/editable_volume.h"

#include "tests/shapes.h"
#include "tests/support/mesh_checks.h"

namespace osteomill {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::mesh_of;
using testing_support::mesh_surface;
using testing_support::shape_volume;
using testing_support::SurfaceMesh;

DensityView at_isovalue(const Volume& volume, double isovalue) {
  return {volume.grid(), volume.ranges(), isovalue};
}

// Raises or lowers a voxel's density.
VoxelBox set_density(Volume& volume, const VoxelIndex& v, float density) {
  constexpr int kSide = DensityBlock::kVoxels;
  DensityBlock block(volume.grid(), {v.i / kSide * kSide, v.j / kSide * kSide, v.k / kSide * kSide});
  block.densities[block.index_of(v)] = density;
  return EditableVolume(volume).swap(block);
}

TEST(SurfaceUpkeep, IncrementalRemeshEqualsFullMesh) {
  Volume volume = shape_volume(centred_cube(51, 0.25), ball(Vec3::Zero(), 5.0));
  const SurfaceBricks layout(volume.geometry().dims);
  SurfaceUpkeep upkeep{layout};
  SurfaceMesh kept{layout, std::vector<BrickMesh>(layout.count())};
  const auto take = [&] {
    const ChangedBricks changed = upkeep.remesh(DensityView(volume));
    const std::size_t count = changed.size();
    for (const auto& [number, brick] : changed) kept.bricks[number] = mesh_of(brick);
    return count;
  };
  EXPECT_GT(take(), 20u);  // of 64
  // A hole is cut and filled again, across bricks.
  for (const float density : {0.0f, 1000.0f}) {
    for (int k = 40; k < 46; ++k) {
      for (int i = 12; i <= 20; ++i) upkeep.mark(set_density(volume, {i, 25, k}, density));
    }
    const std::size_t meshed = take();
    EXPECT_GT(meshed, 0u);
    EXPECT_LT(meshed, 20u);
    EXPECT_EQ(kept.bricks, mesh_surface(DensityView(volume)).bricks);
  }
}

TEST(SurfaceUpkeep, BuildsLevelsOfMilledBricksOnlyOnceAtRest) {
  Volume volume = shape_volume(centred_cube(51, 0.25), ball(Vec3::Zero(), 5.0));
  SurfaceUpkeep upkeep{SurfaceBricks(volume.geometry().dims)};
  const auto has_levels = [](const auto& changed) {
    return changed.second.levels.back().count < changed.second.levels.front().count;
  };
  const ChangedBricks first = upkeep.remesh(DensityView(volume));
  EXPECT_TRUE(std::all_of(first.begin(), first.end(), has_levels));
  const VoxelBox row{{12, 25, 45}, {40, 25, 45}};
  for (int i = row.first.i; i <= row.last.i; ++i) volume.lower_density({i, 25, 45}, 0);
  std::size_t milled = 0;  // more than get their levels in one call
  for (int n = 0; n < 2 * SurfaceUpkeep::kCallsUntilRest; ++n) {
    upkeep.mark(row);
    const ChangedBricks changed = upkeep.remesh(DensityView(volume));
    milled = changed.size();
    EXPECT_GT(milled, SurfaceUpkeep::kMaxRefinedPerCall);
    EXPECT_TRUE(std::none_of(changed.begin(), changed.end(), has_levels));
  }
  for (int n = 2; n < SurfaceUpkeep::kCallsUntilRest; ++n)
    EXPECT_TRUE(upkeep.remesh(DensityView(volume)).empty());
  // Only a few per call, so that no call takes long.
  for (std::size_t left = milled; left > 0;) {
    const ChangedBricks at_rest = upkeep.remesh(DensityView(volume));
    EXPECT_EQ(at_rest.size(), std::min(left, SurfaceUpkeep::kMaxRefinedPerCall));
    EXPECT_TRUE(std::all_of(at_rest.begin(), at_rest.end(), has_levels));
    ASSERT_FALSE(at_rest.empty());
    left -= at_rest.size();
  }
  EXPECT_TRUE(upkeep.remesh(DensityView(volume)).empty());
}

TEST(SurfaceUpkeep, ReportsBricksThatBecameEmpty) {
  const Volume volume = shape_volume(centred_cube(40, 0.25), ball({-4, -4, -4}, 0.6));
  SurfaceUpkeep upkeep{SurfaceBricks(volume.geometry().dims)};
  EXPECT_EQ(upkeep.remesh(at_isovalue(volume, 500)).size(), 1u);
  upkeep.mark_all();
  const ChangedBricks changed = upkeep.remesh(at_isovalue(volume, 5000));
  ASSERT_EQ(changed.size(), 1u);
  EXPECT_TRUE(changed.begin()->second.empty());
  EXPECT_TRUE(upkeep.remesh(at_isovalue(volume, 5000)).empty());
}

}  // namespace
}  // namespace osteomill
