#include "osteomill/haptics/bone_points/bone_bricks.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/random.h"
#include "tests/shapes.h"
#include <gtest/gtest.h>

#include "osteomill/haptics/bone_points/every_point.h"

namespace osteomill {
namespace {

using testing_support::uniform;

void make_all(BoneBricks& bricks) {
  for_each_point(bricks, [](const Vec3&, double) {});
}

// Bricks brought up to date by the sweep, a little a tick, hold in the end what bricks made anew hold; on the
// way no part of the old surface is missing before the new one is there.
TEST(BoneBricks, MillingBringsThemUpToDateWithinABudget) {
  for (const double voxel_mm : {0.06, 0.125, 0.4}) {
    Volume volume =
        testing_support::shape_volume(testing_support::centred_cube(static_cast<int>(6 / voxel_mm), voxel_mm),
                                      testing_support::ball(Vec3::Zero(), 2));
    BoneBricks kept(volume, 0.13, BoneBricks::Points::fine_and_coarse);
    make_all(kept);
    VoxelBox changed;
    const auto& dims = volume.geometry().dims;
    for (int k = 0; k < dims[2]; ++k) {
      for (int j = 0; j < dims[1]; ++j) {
        for (int i = 0; i < dims[0]; ++i) {
          const double distance =
              (volume.geometry().world_from_voxel(VoxelIndex{i, j, k}) - Vec3(0, 0, 1.6)).norm();
          const float max = static_cast<float>(1000 * std::clamp((distance - 1.2) / 0.5, 0.0, 1.0));
          if (volume.grid()[{i, j, k}] <= max) continue;
          volume.lower_density({i, j, k}, max);
          changed.include({i, j, k});
        }
      }
    }
    kept.refresh(changed, 200);
    int ticks = 1;
    for (; !kept.is_up_to_date(); ++ticks) kept.refresh({}, 200);
    EXPECT_GT(ticks, 3);
    BoneBricks anew(volume, 0.13, BoneBricks::Points::fine_and_coarse);
    std::vector<Vec3> kept_points, new_points;
    for_each_point(kept, [&](const Vec3& p, double) { kept_points.push_back(p); });
    for_each_point(anew, [&](const Vec3& p, double) { new_points.push_back(p); });
    EXPECT_EQ(kept_points, new_points) << voxel_mm;
    EXPECT_EQ(kept.octree().total(), anew.octree().total());
  }
}

// Lowers densities at random: here a little, there to nothing, in boxes such as a burr's.
VoxelBox mill_at_random(Volume& volume, std::mt19937& bits) {
  const auto& dims = volume.geometry().dims;
  const VoxelIndex first{static_cast<int>(bits() % static_cast<unsigned>(dims[0])),
                         static_cast<int>(bits() % static_cast<unsigned>(dims[1])),
                         static_cast<int>(bits() % static_cast<unsigned>(dims[2]))};
  VoxelBox changed;
  for (int n = 0; n < 60; ++n) {
    const VoxelIndex v{first.i + static_cast<int>(bits() % 10), first.j + static_cast<int>(bits() % 7),
                       first.k + static_cast<int>(bits() % 5)};
    if (!volume.grid().contains(v)) continue;
    const double left = bits() % 2 == 0 ? 0.0 : uniform(bits, 0.6, 1.0);
    volume.lower_density(v, static_cast<float>(left * static_cast<double>(volume.grid()[v])));
    changed.include(v);
  }
  return changed;
}

// Whatever fell, and while what fell first still waits: in the end all is as if made anew, and on the way
// every point is finite.
TEST(BoneBricks, MilledAtRandomTheyAreInTheEndAsMadeAnew) {
  GridGeometry geometry = testing_support::centred_cube(36, 0.2);
  geometry.spacing_mm = {0.2, 0.25, 0.3};
  for (const double spacing_mm : {0.13, 0.4}) {
    for (const int budget : {1, 50, 1000}) {
      Volume volume = testing_support::shape_volume(geometry, testing_support::ball({0, 0, -0.3}, 3.4));
      BoneBricks kept(volume, spacing_mm, BoneBricks::Points::fine);
      make_all(kept);
      std::mt19937 bits(11);
      for (int n = 0; n < 40; ++n) {
        kept.refresh(mill_at_random(volume, bits), budget);
        for_each_point(kept, [&](const Vec3& p, double area) {
          ASSERT_LT(p.norm(), 100);
          ASSERT_TRUE(area > 0 && std::isfinite(area));
        });
      }
      while (!kept.is_up_to_date()) kept.refresh({}, budget);
      BoneBricks anew(volume, spacing_mm, BoneBricks::Points::fine);
      std::vector<Vec3> kept_points, new_points;
      for_each_point(kept, [&](const Vec3& p, double) { kept_points.push_back(p); });
      for_each_point(anew, [&](const Vec3& p, double) { new_points.push_back(p); });
      EXPECT_EQ(kept_points, new_points) << spacing_mm << ", " << budget;
      EXPECT_EQ(kept.dropped(), 0u);
    }
  }
}

// Bone in every brick of a scan, all asked for at once.
TEST(BoneBricks, ABrickThatFoundNoRoomIsMadeWhenThereIs) {
  const Volume volume =
      testing_support::shape_volume(testing_support::centred_cube(224, 0.13), [](const Vec3& p) {
        return 0.4 - std::abs(std::remainder(p.x(), 0.9)) - std::abs(std::remainder(p.y(), 0.9));
      });
  BoneBricks bricks(volume, 0.13, BoneBricks::Points::fine);
  const auto& dims = bricks.octree().dims(0);
  const auto all = [&](const auto& visit) {
    for (int k = 0; k < dims[2]; ++k) {
      for (int j = 0; j < dims[1]; ++j) {
        for (int i = 0; i < dims[0]; ++i) visit(VoxelIndex{i, j, k});
      }
    }
  };
  std::vector<VoxelIndex> missing;
  all([&](const VoxelIndex& brick) {
    if (bricks.slot_of(brick) == BoneBricks::kNoPoints) missing.push_back(brick);
  });
  const MillingTool far_away{1.5, 1, 25};
  bricks.make_room(far_away, {{1000, 0, 0}, Quat::Identity()});
  std::size_t made = 0;
  for (const VoxelIndex& brick : missing) {
    const std::uint32_t slot = bricks.slot_of(brick);
    if (slot == BoneBricks::kNoPoints) continue;
    ++made;
    EXPECT_GT(bricks.fine().brick(slot).count, 0u);
  }
  EXPECT_GT(made, 100u);
}

}  // namespace
}  // namespace osteomill
