#include "osteomill/haptics/point_shell/brick_kernel.h"

#include <cmath>
#include <random>
#include <vector>

#include "tests/instruction_sets.h"
#include "tests/random.h"
#include "tests/shapes.h"
#include <gtest/gtest.h>

#include "osteomill/haptics/point_shell/brick_contacts.h"

namespace osteomill::point_shell {
namespace {

using testing_support::ForcedInstructionSet;
using testing_support::instruction_sets_here;
using testing_support::random_vector;

// A ball, bored through and milled at random.
BoneBricks bored_ball(Volume& volume, std::mt19937& bits) {
  volume = testing_support::shape_volume(testing_support::centred_cube(60, 0.2), [](const Vec3& p) {
    return std::max(p.norm() - 5, 0.97 - std::hypot(p.x(), p.y()));
  });
  for (int n = 0; n < 3000; ++n) {
    const VoxelIndex v{static_cast<int>(bits() % 60), static_cast<int>(bits() % 60),
                       static_cast<int>(bits() % 60)};
    volume.lower_density(v, 0.3f * volume.grid()[v]);
  }
  return BoneBricks(volume, BoneBricks::kSpacing_mm, BoneBricks::Points::fine);
}

bool same_bits(const ContactSum& a, const ContactSum& b) {
  return a.force_N == b.force_N && a.torque_Nmm == b.torque_Nmm && a.K_ff == b.K_ff && a.K_ft == b.K_ft &&
         a.K_tt == b.K_tt;
}

// Tools whose shaft is narrower and wider than the burr, and one so short that all of its parts are near
// another.
const MillingTool kTools[] = {{1.5, 1.0, 25}, {0.8, 1.2, 6}, {2, 0.5, 12}, {0.7, 0.7, 1.5}};

TEST(BrickKernel, EveryInstructionSetGivesTheSameBits) {
  std::mt19937 bits(31);
  Volume volume(DensityGrid(testing_support::centred_cube(1, 1), std::vector<float>{0}), 0);
  BoneBricks bricks = bored_ball(volume, bits);
  const std::vector<std::int64_t> targets = instruction_sets_here(kernel_targets());
  RecordProperty("targets", static_cast<int>(targets.size()));
  ASSERT_GE(targets.size(), 1u);
  int touched = 0;
  for (const MillingTool& tool : kTools) {
    for (int n = 0; n < 60; ++n) {
      // Sleeved in the bore, also to the last bit on its axis, and anywhere.
      Pose X_WT{{0.02, 0.03, -2}, quaternion_from_rotation_vector({0.01, 0.02, 0})};
      if (n == 1) X_WT = {{0, 0, -2}, Quat::Identity()};
      if (n > 1) X_WT = {6 * random_vector(bits), quaternion_from_rotation_vector(3 * random_vector(bits))};
      const double patch_mm2 = n % 2 == 0 ? 0.0 : 2 * bricks.lattice().cell_area_mm2();
      const Penalty penalty{20, patch_mm2};
      std::vector<ToolContacts> fast;
      for (const std::int64_t target : targets) {
        const ForcedInstructionSet forced(target);
        fast.push_back(contacts_by_bricks(bricks, tool, X_WT, penalty));
        EXPECT_EQ(fast.back().touching, fast.front().touching) << hwy::TargetName(target);
        EXPECT_TRUE(same_bits(fast.back().burr, fast.front().burr)) << hwy::TargetName(target);
        EXPECT_TRUE(same_bits(fast.back().shaft, fast.front().shaft)) << hwy::TargetName(target);
      }
      touched += fast.front().touching;
    }
  }
  EXPECT_GT(touched, 10000);
}

TEST(BrickKernel, SlotsWithoutAPointAddNothing) {
  PointChunk chunk;
  const ShellPoint nowhere{PointChunk::kFarAway_mm, PointChunk::kFarAway_mm, PointChunk::kFarAway_mm, 0};
  for (std::size_t slot = 0; slot < PointChunk::kSlots; ++slot) chunk.set(slot, nowhere);
  const KernelTool tool{1.5, 1.0, 25, std::sqrt(1.25), 20, 0.03, 0.09};
  const KernelFrame frame{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}};
  KernelSums sums;
  EXPECT_EQ(add_points(chunk, frame, tool, sums), 0u);
  // One point among them, 0.25 mm deep in the burr.
  chunk.set(5, {0, -1.25f, 0, 0.01f, 0, 1, 0});
  EXPECT_EQ(add_points(chunk, frame, tool, sums), 0u);
  EXPECT_EQ(sums.touching, 1);
  double push = 0;
  for (const double lane : sums.sphere[1]) push += lane;
  const double area = static_cast<double>(0.01f);
  EXPECT_NEAR(push, -20 * area * (0.25 - area * (2 / 1.5) / 24), 1e-12);
}

}  // namespace
}  // namespace osteomill::point_shell
