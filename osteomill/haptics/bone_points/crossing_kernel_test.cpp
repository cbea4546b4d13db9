#include "osteomill/haptics/bone_points/crossing_kernel.h"

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "tests/instruction_sets.h"
#include "tests/random.h"
#include <gtest/gtest.h>

namespace osteomill {
namespace {

using testing_support::ForcedInstructionSet;
using testing_support::instruction_sets_here;
using testing_support::uniform;

constexpr float kIsovalue = 0.4f;
constexpr int kSide = 12;

// Eight nodes in a block of random densities, and the edges from them that are crossed.
struct Scene {
  std::vector<float> block;
  CrossingLattice lattice{{1, kSide, kSide* kSide}, kIsovalue, {}};
  CrossingRow row{};

  explicit Scene(std::mt19937& bits) {
    for (int n = 0; n < kSide * kSide * 5; ++n) block.push_back(static_cast<float>(uniform(bits, 0, 1)));
    row = {&block[2 * kSide * kSide + 2 * kSide + 1], -1, 3, 5, {0, 0, 0}};
    for (int axis = 0; axis < 3; ++axis) {
      lattice.steps.step[axis] = 0.1f + 0.02f * static_cast<float>(axis);
      lattice.steps.per_step[axis] = 1 / lattice.steps.step[axis];
      lattice.steps.face[axis] = 0.01f;
      for (std::size_t n = 0; n < CrossingRow::kNodes; ++n) {
        const float* here = row.densities + n;
        const bool crossed = (*here > kIsovalue) != (here[lattice.next[axis]] > kIsovalue);
        row.crossed[axis] |= static_cast<std::uint32_t>(crossed) << n;
      }
    }
  }
};

// The same in double precision, a crossing after the other.
std::vector<double> plain_sums(const Scene& scene, std::size_t node) {
  const auto& [next, isovalue, steps] = scene.lattice;
  std::vector<double> sums(CrossingSums::kSums);
  for (int axis = 0; axis < 3; ++axis) {
    if ((scene.row.crossed[axis] >> node & 1) == 0) continue;
    const float* here = scene.row.densities + node;
    const float* there = here + next[axis];
    const double fraction = (double{isovalue} - double{*here}) / (double{*there} - double{*here});
    double gradient[3], length2 = 0;
    for (int a = 0; a < 3; ++a) {
      const double from = double{here[next[a]]} - double{here[-next[a]]};
      const double to = double{there[next[a]]} - double{there[-next[a]]};
      gradient[a] = (from + fraction * (to - from)) / double{steps.step[a]};
      length2 += gradient[a] * gradient[a];
    }
    const double outward = -1 / std::sqrt(length2);
    const double area = double{steps.face[axis]} * std::max(0.02, std::abs(outward * gradient[axis]));
    double at[3] = {static_cast<double>(scene.row.i) + static_cast<double>(node),
                    static_cast<double>(scene.row.j), static_cast<double>(scene.row.k)};
    at[axis] += fraction;
    for (std::size_t a = 0; a < 3; ++a) {
      sums[a] += area * at[a] * double{steps.step[a]};
      sums[4 + a] += area * outward * gradient[a];
    }
    sums[3] += area;
  }
  return sums;
}

TEST(CrossingKernel, EveryInstructionSetGivesTheSameBitsAndThePlainSums) {
  std::mt19937 bits(7);
  const std::vector<std::int64_t> sets = instruction_sets_here(crossing_kernel_targets());
  ASSERT_GE(sets.size(), 1u);
  for (int n = 0; n < 200; ++n) {
    const Scene scene(bits);
    std::vector<CrossingSums> sums;
    for (const std::int64_t set : sets) {
      const ForcedInstructionSet forced(set);
      add_crossings(scene.lattice, scene.row, sums.emplace_back(CrossingSums{}));
      EXPECT_EQ(std::memcmp(&sums.back(), &sums.front(), sizeof(CrossingSums)), 0) << hwy::TargetName(set);
    }
    for (std::size_t node = 0; node < CrossingRow::kNodes; ++node) {
      const std::vector<double> plain = plain_sums(scene, node);
      for (std::size_t sum = 0; sum < plain.size(); ++sum) {
        EXPECT_NEAR(static_cast<double>(sums.front().rows[sum][node]), plain[sum], 2e-7);
      }
    }
  }
}

// Densities that go up and down again from node to node: no gradient says how the surface lies.
TEST(CrossingKernel, WithoutANormalACrossingStillHasAnArea) {
  std::vector<float> block(kSide * kSide * 5);
  for (std::size_t n = 0; n < block.size(); ++n) block[n] = static_cast<float>(n % 2);
  const float* here = &block[2 * kSide * kSide + 2 * kSide + 2];
  const CrossingLattice lattice{{1, kSide, kSide * kSide}, kIsovalue, {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
  CrossingSums sums{};
  add_crossings(lattice, {here, 0, 0, 0, {1, 0, 0}}, sums);
  EXPECT_GT(sums.rows[3][0], 0.5f);
  EXPECT_EQ(sums.rows[4][0], 0.0f);
  EXPECT_EQ(sums.rows[3][1], 0.0f);
}

}  // namespace
}  // namespace osteomill
