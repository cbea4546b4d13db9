#include "cut_kernel.h"

#include <bit>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/milling/cut_voxels.h"

#include "tests/instruction_sets.h"

namespace osteomill {
namespace {

using testing_support::available_instruction_sets;
using testing_support::ForcedInstructionSet;

constexpr double kRadius_mm = 1.3;
const CutProfile kProfile = CutProfile::between(-100, 450, 1000);

Volume random_bone(const Vec3& spacing_mm) {
  GridGeometry geometry;
  geometry.dims = {31, 27, 22};
  geometry.spacing_mm = spacing_mm;
  std::mt19937 bits(5);
  std::vector<float> densities;
  for (std::size_t n = 0; n < geometry.voxel_count(); ++n) {
    densities.push_back(static_cast<float>(bits() % 1500) - 200);
  }
  return Volume(DensityGrid(geometry, densities), 450);
}

struct Gathered {
  BurrReach reach;
  CutVoxels voxels;
  CuttingBall ball;
};
Gathered gathered(const Volume& bone, double max_ahead_mm) {
  const GridGeometry& geometry = bone.geometry();
  const Vec3 middle = 0.5 * geometry.spacing_mm.cwiseProduct(Vec3(30.3, 26.1, 21.7));
  Gathered g{BurrReach(bone, 2.5, -100),
             CutVoxels(geometry, geometry.voxel_count(), 3 * 27 * 22 * 4),
             {middle, Vec3(0.5, -0.3, 0.8).normalized(), kRadius_mm}};
  g.reach.find(middle, 2.3);
  g.voxels.gather(g.reach, g.ball, kProfile, max_ahead_mm);
  return g;
}

// Returns the drops of the leading and the trailing half, computed per voxel in double.
CutVoxels::Cost plain_cost(const Volume& bone, const CuttingBall& ball, double ahead_mm) {
  const GridGeometry& geometry = bone.geometry();
  CutVoxels::Cost cost;
  for (int k = 0; k < geometry.dims[2]; ++k)
    for (int j = 0; j < geometry.dims[1]; ++j)
      for (int i = 0; i < geometry.dims[0]; ++i) {
        const Vec3 from = geometry.spacing_mm.cwiseProduct(Vec3(i, j, k)) - ball.centre_mm;
        const bool leads = from.dot(ball.ahead) > 0;
        const double outside_mm = (leads ? (from - ahead_mm * ball.ahead).norm() : from.norm()) - kRadius_mm;
        const double voxel_mm = from.cwiseProduct(geometry.spacing_mm).norm() / from.norm();
        const double left = static_cast<double>(kProfile.density(static_cast<float>(outside_mm / voxel_mm)));
        const double drop = std::max(0.0, static_cast<double>(bone.grid()[{i, j, k}]) - left);
        (leads ? cost.leading : cost.trailing) += drop;
      }
  return cost;
}

TEST(CutKernel, CostMatchesAPlainSumOfDensityDrops) {
  for (const Vec3& spacing_mm : {Vec3(0.15, 0.15, 0.15), Vec3(0.12, 0.15, 0.2)}) {
    const Volume bone = random_bone(spacing_mm);
    const Gathered g = gathered(bone, 0.2);
    for (const double ahead_mm : {0.2, 0.07, 0.0, -0.3}) {
      const CutVoxels::Cost cost = g.voxels.cost(ahead_mm), plain = plain_cost(bone, g.ball, ahead_mm);
      EXPECT_NEAR(cost.leading, plain.leading, 1e-3 * plain.leading) << ahead_mm;
      EXPECT_NEAR(cost.trailing, plain.trailing, 1e-3 * plain.trailing) << ahead_mm;
      constexpr double kStep_mm = 1e-4;
      const double slope = (plain_cost(bone, g.ball, ahead_mm + kStep_mm).leading -
                            plain_cost(bone, g.ball, ahead_mm - kStep_mm).leading) /
                           (2 * kStep_mm);
      EXPECT_NEAR(cost.slope_per_mm, slope, 0.02 * slope) << ahead_mm;
    }
  }
}

TEST(CutKernel, IsBitIdenticalForEveryInstructionSet) {
  const Volume bone = random_bone(Vec3(0.12, 0.15, 0.2));
  const std::vector<std::int64_t> targets = available_instruction_sets(cut_kernel_targets());
  ASSERT_GE(targets.size(), 2u);
  std::vector<double> first;
  for (const std::int64_t target : targets) {
    const ForcedInstructionSet forced(target);
    Gathered g = gathered(bone, 0.2);
    const CutVoxels::Cost cost = g.voxels.cost(0.11);
    std::vector<double> numbers{cost.leading, cost.slope_per_mm, cost.trailing,
                                g.voxels.find_lowered(0.11, {0.7, 0.4})};
    for (const CutVoxels::Row& row : g.voxels.rows()) {
      for (std::size_t n = row.begin; n < row.end; ++n) {
        numbers.push_back(g.voxels.columns()[n]);
        numbers.push_back(static_cast<double>(g.voxels.after()[n]));
      }
    }
    if (first.empty()) first = numbers;
    EXPECT_GT(numbers.size(), 500u);
    EXPECT_EQ(numbers, first) << hwy::TargetName(target);
  }
}

TEST(CutKernel, InstructionsAreChosenBeforeTheTick) {
  hwy::GetChosenTarget().DeInit();
  const CutVoxels voxels(random_bone({1, 1, 1}).geometry(), 1, 1);
  EXPECT_TRUE(hwy::GetChosenTarget().IsInitialized());
}

TEST(BurrAdvance, SpendsTheBudgetAndNoMore) {
  const Volume bone = random_bone(Vec3(0.12, 0.15, 0.2));
  Gathered g = gathered(bone, 0.2);
  const CutVoxels::Cost all = g.voxels.cost(0.2);
  for (const double share : {1e-3, 0.1, 0.5, 0.9}) {
    for (const double start_mm : {-1.0, 0.0, 0.1}) {
      const double budget = share * (all.leading + all.trailing);
      const BurrAdvance advance = advance_within(budget, g.voxels, start_mm, -1, 0.2);
      const double spent = g.voxels.find_lowered(advance.ahead_mm, advance.shares);
      EXPECT_LE(spent, budget * (1 + 1e-5)) << share;
      EXPECT_GE(spent, 0.985 * budget) << share;
    }
  }
  for (const double budget : {0.0, -1e-9}) {
    const BurrAdvance none = advance_within(budget, g.voxels, 0, -1, 0.2);
    EXPECT_LE(g.voxels.find_lowered(none.ahead_mm, none.shares), 1e-3)
        << budget << ", up to the rounding of floats";
  }
  const BurrAdvance more = advance_within(3 * (all.leading + all.trailing), g.voxels, 0, -1, 0.2);
  EXPECT_EQ(more.ahead_mm, 0.2) << "the limit";
  EXPECT_NEAR(g.voxels.find_lowered(more.ahead_mm, more.shares), all.leading + all.trailing, 1);
}

}  // namespace
}  // namespace osteomill
