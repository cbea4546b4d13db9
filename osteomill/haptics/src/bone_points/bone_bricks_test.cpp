#include "bone_points/bone_bricks.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/random.h"
#include "tests/shapes.h"
#include "tests/support/every_point.h"

namespace osteomill {
namespace {

// Selects the nodes whose bounding spheres come within a distance of a point.
auto near(const SurfaceLattice& lattice, const Vec3& place_G, double within_mm) {
  return [&lattice, place_G, within_mm](int level, const VoxelIndex& node) {
    unsigned met = 0;
    for (int n = 0; n < 8; ++n) {
      const Vec3 middle_G = lattice.middle_G(level - 1, BrickTree::below(node, n));
      const bool is_near = (middle_G - place_G).norm() < within_mm + lattice.radius_mm(level - 1);
      met |= static_cast<unsigned>(is_near) << n;
    }
    return static_cast<BrickTree::EightBits>(met);
  };
}

using testing_support::uniform;

void make_all(BoneBricks& bricks) {
  for_each_point(bricks, [](const Vec3&, double) {});
}

// Bricks updated over several ticks end with the same points as newly built ones; meanwhile no part of the
// old surface disappears before the new one is there.
TEST(BoneBricks, BudgetedRefreshAfterMillingEndsEqualToARebuild) {
  for (const double voxel_mm : {0.06, 0.125, 0.4}) {
    Volume volume =
        testing_support::shape_volume(testing_support::centred_cube(static_cast<int>(6 / voxel_mm), voxel_mm),
                                      testing_support::ball(Vec3::Zero(), 2));
    BoneBricks kept(volume, 0.13);
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
    BoneBricks anew(volume, 0.13);
    std::vector<Vec3> kept_points, new_points;
    for_each_point(kept, [&](const Vec3& p, double) { kept_points.push_back(p); });
    for_each_point(anew, [&](const Vec3& p, double) { new_points.push_back(p); });
    EXPECT_EQ(kept_points, new_points) << voxel_mm;
    EXPECT_EQ(kept.fine().total(), anew.fine().total());
  }
}

// Lowers densities at random, slightly or to zero, in boxes the size of a burr's.
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

// Densities fall anywhere, also while earlier changes are pending: in the end all bricks equal newly built
// ones, and meanwhile every point is finite.
TEST(BoneBricks, EqualRebuiltOnesAfterRandomMilling) {
  GridGeometry geometry = testing_support::centred_cube(36, 0.2);
  geometry.spacing_mm = {0.2, 0.25, 0.3};
  for (const double spacing_mm : {0.13, 0.4}) {
    for (const int budget : {1, 50, 1000}) {
      Volume volume = testing_support::shape_volume(geometry, testing_support::ball({0, 0, -0.3}, 3.4));
      BoneBricks kept(volume, spacing_mm);
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
      BoneBricks anew(volume, spacing_mm);
      std::vector<Vec3> kept_points, new_points;
      for_each_point(kept, [&](const Vec3& p, double) { kept_points.push_back(p); });
      for_each_point(anew, [&](const Vec3& p, double) { new_points.push_back(p); });
      EXPECT_EQ(kept_points, new_points) << spacing_mm << ", " << budget;
      EXPECT_EQ(kept.dropped(), 0u);
    }
  }
}

// The surface falls everywhere in every tick, faster than the other bricks take their turns.
TEST(BoneBricks, RefreshSupportingBricksWithinFourTicks) {
  Volume volume = testing_support::shape_volume(testing_support::centred_cube(90, 0.13),
                                                testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
  BoneBricks kept(volume, 0.13);
  const auto at_the_middle = [](BoneBricks& bricks, const auto& use) {
    const Vec3 middle_G = Vec3::Constant(0.5 * 89 * 0.13);
    bricks.build_and_visit(near(bricks.lattice(), middle_G, 0.6),
                           [&](const VoxelIndex&, std::uint32_t slot) { use(slot); });
  };
  make_all(kept);
  const auto heights = [&](BoneBricks& bricks) {
    std::vector<float> z_mm;
    at_the_middle(bricks, [&](std::uint32_t slot) {
      bricks.fine().for_each_of(slot, [&](const ShellPoint& point) { z_mm.push_back(point.z_mm); });
    });
    return z_mm;
  };
  int supporting = 0;
  at_the_middle(kept,
                [&](std::uint32_t slot) { kept.add_supporting(slot, supporting++ == 0 ? 1.0f : 0.0f); });
  ASSERT_GT(supporting, 4);
  const VoxelBox all = volume.geometry().all_voxels();
  constexpr int kTicks = 30, kTurns = 4;
  std::vector<std::vector<float>> as_made_anew;
  for (int tick = 0; tick < kTicks; ++tick) {
    for_each(all, [&](const VoxelIndex& v) {
      const float density = volume.grid()[v];
      if (density > 0 && density < 1000) volume.lower_density(v, std::max(0.0f, density - 2));
    });
    kept.refresh(all, 1);
    BoneBricks anew(volume, 0.13);
    as_made_anew.push_back(heights(anew));
  }
  // Every brick's height must match that of one of the last ticks.
  const std::vector<float> now = heights(kept);
  ASSERT_EQ(now.size(), as_made_anew.back().size());
  for (std::size_t n = 0; n < now.size(); ++n) {
    bool of_late = false;
    for (int tick = kTicks - kTurns; tick < kTicks; ++tick)
      of_late |= now[n] == as_made_anew[static_cast<std::size_t>(tick)][n];
    EXPECT_TRUE(of_late) << n;
  }
}

// Returns false as long as bricks are missing.
TEST(BoneBricks, BuildNoMorePointsPerTickThanTheBudgetAllows) {
  const Volume volume = testing_support::shape_volume(testing_support::centred_cube(150, 0.13),
                                                      testing_support::ball(Vec3::Zero(), 8));
  BoneBricks bricks(volume, 0.13);
  std::size_t before = 0;
  int ticks = 0;
  for (bool all = false; !all; ++ticks) {
    bricks.begin_tick({}, {});
    all = bricks.build_and_visit(every_node, [](const VoxelIndex&, std::uint32_t) {});
    EXPECT_LE(bricks.fine().total(),
              before + UpdateQueue::kBuiltPointsPerMs + SurfaceLattice::kMaxPointsOfBrick);
    before = bricks.fine().total();
    ASSERT_LT(ticks, 1000);
  }
  EXPECT_GT(ticks, 10);
  BoneBricks at_once(volume, 0.13);
  make_all(at_once);
  EXPECT_EQ(bricks.fine().total(), at_once.fine().total());
}

TEST(BoneBricks, RefreshingACopyLeavesTheOriginalUnchanged) {
  Volume volume = testing_support::shape_volume(testing_support::centred_cube(60, 0.2),
                                                testing_support::ball(Vec3::Zero(), 4));
  BoneBricks kept(volume, 0.13);
  make_all(kept);
  const std::size_t points = kept.fine().total();
  BoneBricks copy = kept;
  std::mt19937 bits(5);
  for (int n = 0; n < 200; ++n) copy.refresh(mill_at_random(volume, bits), 1000);
  copy.evict_far_bricks({}, {{1000, 0, 0}, Quat::Identity()});
  EXPECT_NE(copy.fine().total(), points);
  EXPECT_EQ(kept.fine().total(), points);
}

// Requests at once all bricks of a scan that has bone in every brick.
TEST(BoneBricks, BuildSkippedBricksOnceSpaceIsFreed) {
  const Volume volume =
      testing_support::shape_volume(testing_support::centred_cube(224, 0.13), [](const Vec3& p) {
        return 0.4 - std::abs(std::remainder(p.x(), 0.9)) - std::abs(std::remainder(p.y(), 0.9));
      });
  BoneBricks bricks(volume, 0.13);
  const auto made_about = [&](const Vec3& middle_G, double within_mm) {
    std::size_t made = 0;
    bricks.build_and_visit(
        near(bricks.lattice(), middle_G, within_mm),
        [&](const VoxelIndex&, std::uint32_t slot) { made += bricks.fine().brick(slot).count > 0; });
    return made;
  };
  const Vec3 last_G = Vec3::Constant(223 * 0.13);
  EXPECT_GT(made_about({0, 0, 0}, 1000), 3000u);
  EXPECT_EQ(made_about(last_G, 6), 0u);
  const MillingTool far_away{1.5, 1, 25};
  bricks.evict_far_bricks(far_away, {{1000, 0, 0}, Quat::Identity()});
  EXPECT_GT(made_about(last_G, 6), 100u);
}

// In bone a metre wide, bricks are evicted in time and rebuilt when the tool returns.
TEST(BoneBricks, KeepFindingPointsWithEvictionInAMetreWideScan) {
  const Volume volume = testing_support::shape_volume(testing_support::centred_cube(11, 100.0),
                                                      testing_support::plane({0, 0, 10}, {0, 0, 1}));
  BoneBricks bricks(volume, 0.13);
  std::mt19937 bits(3);
  for (int n = 0; n < 6000; ++n) {
    const Vec3 at_G(uniform(bits, 1, 999), uniform(bits, 1, 999), 510);
    int found = 0;
    bricks.build_and_visit(near(bricks.lattice(), at_G, 0.1), [&](const VoxelIndex&, std::uint32_t slot) {
      found += static_cast<int>(bricks.fine().brick(slot).count);
    });
    ASSERT_GT(found, 10) << n;
    bricks.evict_far_bricks({}, {{0, 0, 1000}, Quat::Identity()});
  }
}

}  // namespace
}  // namespace osteomill
