#include "osteomill/haptics/point_shell/brick_kernel.h"

#include <cmath>
#include <random>
#include <vector>

#include "tests/shapes.h"
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "osteomill/haptics/point_shell/brick_contacts.h"
#include "osteomill/haptics/point_shell/octree_contacts.h"

namespace osteomill::point_shell {
namespace {

// Every set of vector instructions that this processor has and the kernel was compiled for.
std::vector<std::int64_t> targets_here() {
  std::vector<std::int64_t> targets;
  const std::int64_t both = hwy::SupportedTargets() & kernel_targets();
  for (int place = 0; place < 63; ++place) {
    const std::int64_t bit = std::int64_t{1} << place;
    if ((both & bit) != 0) targets.push_back(bit);
  }
  return targets;
}

// Uses one set while it lives.
struct Forced {
  explicit Forced(std::int64_t target) { hwy::SetSupportedTargetsForTest(target); }
  ~Forced() { hwy::SetSupportedTargetsForTest(0); }
};

double unit_random(std::mt19937& bits) {
  return 2 * (static_cast<double>(bits()) / 4294967295.0) - 1;
}
Vec3 random_vector(std::mt19937& bits) {
  const double x = unit_random(bits), y = unit_random(bits), z = unit_random(bits);
  return {x, y, z};
}

// A ball, bored through and milled at random.
PointShell bored_ball(Volume& volume, std::mt19937& bits) {
  volume = testing_support::shape_volume(testing_support::centred_cube(60, 0.2), [](const Vec3& p) {
    return std::max(p.norm() - 5, 0.97 - std::hypot(p.x(), p.y()));
  });
  for (int n = 0; n < 3000; ++n) {
    const VoxelIndex v{static_cast<int>(bits() % 60), static_cast<int>(bits() % 60),
                       static_cast<int>(bits() % 60)};
    volume.lower_density(v, 0.3f * volume.grid()[v]);
  }
  return PointShell(volume, Settings::defaults(Mode::steady).shell);
}

bool same_bits(const ContactSum& a, const ContactSum& b) {
  return a.force_N == b.force_N && a.torque_Nmm == b.torque_Nmm && a.K_ff == b.K_ff && a.K_ft == b.K_ft &&
         a.K_tt == b.K_tt;
}

void expect_near(const ContactSum& a, const ContactSum& b) {
  constexpr double kRelative = 1e-9, kTiny = 1e-9;
  EXPECT_LE((a.force_N - b.force_N).norm(), kRelative * b.force_N.norm() + kTiny);
  EXPECT_LE((a.torque_Nmm - b.torque_Nmm).norm(), kRelative * b.torque_Nmm.norm() + kTiny);
  EXPECT_LE((a.K_ff - b.K_ff).norm(), kRelative * b.K_ff.norm() + kTiny);
  EXPECT_LE((a.K_ft - b.K_ft).norm(), kRelative * b.K_tt.norm() + kTiny);
  EXPECT_LE((a.K_tt - b.K_tt).norm(), kRelative * b.K_tt.norm() + kTiny);
}

// Tools whose shaft is narrower and wider than the burr, and one so short that all of its parts are near
// another.
const MillingTool kTools[] = {{1.5, 1.0, 25}, {0.8, 1.2, 6}, {2, 0.5, 12}, {0.7, 0.7, 1.5}};

TEST(BrickKernel, EveryInstructionSetGivesTheSameBitsAndThePlainSums) {
  std::mt19937 bits(31);
  Volume volume(DensityGrid(testing_support::centred_cube(1, 1), std::vector<float>{0}), 0);
  const PointShell shell = bored_ball(volume, bits);
  const std::vector<std::int64_t> targets = targets_here();
  RecordProperty("targets", static_cast<int>(targets.size()));
  ASSERT_GE(targets.size(), 1u);
  int touched = 0;
  for (const MillingTool& tool : kTools) {
    for (int n = 0; n < 60; ++n) {
      // Sleeved in the bore, also to the last bit on its axis, and anywhere.
      Pose X_WT{{0.02, 0.03, -2}, quaternion_from_rotation_vector({0.01, 0.02, 0})};
      if (n == 1) X_WT = {{0, 0, -2}, Quat::Identity()};
      if (n > 1) X_WT = {6 * random_vector(bits), quaternion_from_rotation_vector(3 * random_vector(bits))};
      const double patch_mm2 = n % 2 == 0 ? 0.0 : 2 * shell.lattice().cell_area_mm2();
      const Penalty penalty{20, patch_mm2};
      const ToolContacts plain = contacts_by_octree(shell, ToolSignedDistance(tool), X_WT, penalty);
      touched += plain.touching;
      std::vector<ToolContacts> fast;
      for (const std::int64_t target : targets) {
        const Forced forced(target);
        fast.push_back(contacts_by_bricks(shell, tool, X_WT, penalty));
        EXPECT_EQ(fast.back().touching, plain.touching) << hwy::TargetName(target);
        EXPECT_TRUE(same_bits(fast.back().burr, fast.front().burr)) << hwy::TargetName(target);
        EXPECT_TRUE(same_bits(fast.back().shaft, fast.front().shaft)) << hwy::TargetName(target);
      }
      expect_near(fast.front().burr, plain.burr);
      expect_near(fast.front().shaft, plain.shaft);
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
