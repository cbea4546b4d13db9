#include "bone_points/brick_kernel.h"

#include <array>
#include <bit>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "bone_points/bone_bricks.h"
#include "tests/instruction_sets.h"
#include "tests/random.h"
#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::available_instruction_sets;
using testing_support::ForcedInstructionSet;
using testing_support::uniform;

constexpr float kIsovalue = 0.4f;
constexpr int kSide = 24;

// The lines of a row of cells in a block of random densities, and the crossed edges that begin at them.
struct Scene {
  int group;
  std::vector<float> block;
  CrossingLattice lattice{{1, kSide, kSide* kSide}, kIsovalue, {}, {}, {}};
  std::vector<CrossingRow> rows;
  std::uint32_t cells = 0;

  Scene(std::mt19937& bits, int nodes_of_cell) : group(nodes_of_cell) {
    for (int n = 0; n < kSide * kSide * (group + 4); ++n) {
      block.push_back(static_cast<float>(uniform(bits, 0, 1)));
    }
    for (int axis = 0; axis < 3; ++axis) {
      lattice.step[axis] = 0.1f + 0.02f * static_cast<float>(axis);
      lattice.per_step[axis] = 1 / lattice.step[axis];
      lattice.face[axis] = 0.01f;
    }
    for (int k = 0; k < group; ++k) {
      for (int j = 0; j < group; ++j) add_row(j, k);
    }
  }

  void add_row(int j, int k) {
    CrossingRow row{&block[static_cast<std::size_t>((2 + k) * kSide * kSide + (2 + j) * kSide + 1)],
                    -1,
                    3 + j,
                    5 + k,
                    {0, 0, 0}};
    const std::size_t nodes = group == 1 ? CrossingRow::kNodes : CrossingRow::kMaxNodes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t n = 0; n < nodes; ++n) {
        const float* here = row.densities + n;
        const bool crossed = (*here > kIsovalue) != (here[lattice.next[axis]] > kIsovalue);
        row.crossed[axis] |= static_cast<std::uint32_t>(crossed) << n;
        if (crossed) cells |= 1u << (n / static_cast<std::size_t>(group));
      }
    }
    rows.push_back(row);
  }
};

// Sums over crossings: area times position, area, area times normal.
using Sums = std::array<double, 7>;

// Adds the crossings in double precision, one by one.
void add_plain(const CrossingLattice& lattice, const CrossingRow& row, std::size_t node, Sums& sums) {
  const auto& [next, isovalue, step, per_step, face] = lattice;
  for (int axis = 0; axis < 3; ++axis) {
    if ((row.crossed[axis] >> node & 1) == 0) continue;
    const float* here = row.densities + node;
    const float* there = here + next[axis];
    const double fraction = (double{isovalue} - double{*here}) / (double{*there} - double{*here});
    double gradient[3], length2 = 0;
    for (int a = 0; a < 3; ++a) {
      const double from = double{here[next[a]]} - double{here[-next[a]]};
      const double to = double{there[next[a]]} - double{there[-next[a]]};
      gradient[a] = (from + fraction * (to - from)) / double{step[a]};
      length2 += gradient[a] * gradient[a];
    }
    const double outward = -1 / std::sqrt(length2);
    const double area = double{face[axis]} * std::max(0.02, std::abs(outward * gradient[axis]));
    double at[3] = {static_cast<double>(row.i) + static_cast<double>(node), static_cast<double>(row.j),
                    static_cast<double>(row.k)};
    at[axis] += fraction;
    for (std::size_t a = 0; a < 3; ++a) {
      sums[a] += area * at[a] * double{step[a]};
      sums[4 + a] += area * outward * gradient[a];
    }
    sums[3] += area;
  }
}

Sums plain_sums(const Scene& scene, std::size_t cell) {
  Sums sums{};
  const auto group = static_cast<std::size_t>(scene.group);
  for (const CrossingRow& row : scene.rows) {
    for (std::size_t n = 0; n < group; ++n) add_plain(scene.lattice, row, cell * group + n, sums);
  }
  return sums;
}

void expect_mean(const ShellPoint& point, const Sums& sums) {
  const Vec3 place(sums[0], sums[1], sums[2]), normal(sums[4], sums[5], sums[6]);
  EXPECT_NEAR(static_cast<double>(point.area_mm2), sums[3], 1e-5 * sums[3] + 2e-7);
  EXPECT_LT((point.position_mm() - place / sums[3]).norm(), 1e-5);
  EXPECT_LT((point.normal() - normal.normalized()).norm(), 1e-6 * sums[3] / normal.norm() + 1e-5);
}

TEST(BrickKernel, AllInstructionSetsAreBitIdenticalAndMatchScalarMeans) {
  std::mt19937 bits(7);
  const std::vector<std::int64_t> sets = available_instruction_sets(brick_kernel_targets());
  ASSERT_GE(sets.size(), 1u);
  for (int n = 0; n < 200; ++n) {
    const Scene scene(bits, 1 << n % 4);
    std::vector<PointRows> found;
    for (const std::int64_t set : sets) {
      const ForcedInstructionSet forced(set);
      add_means(scene.lattice, scene.rows, scene.group, scene.cells, found.emplace_back(16));
      ASSERT_EQ(found.back().count, static_cast<std::size_t>(std::popcount(scene.cells)));
      for (std::size_t at = 0; at < found.back().count; ++at) {
        EXPECT_EQ(found.back().point(at), found.front().point(at)) << hwy::TargetName(set);
      }
    }
    std::size_t at = 0;
    for (std::size_t cell = 0; scene.cells >> cell != 0; ++cell) {
      if ((scene.cells >> cell & 1) != 0) expect_mean(found.front().point(at++), plain_sums(scene, cell));
    }
  }
}

// Densities alternate from node to node, so that no gradient gives the surface's orientation.
TEST(BrickKernel, CrossingWithoutAGradientStillHasAnArea) {
  std::vector<float> block(kSide * kSide * 5);
  for (std::size_t n = 0; n < block.size(); ++n) block[n] = static_cast<float>(n % 2);
  const CrossingRow row{&block[2 * kSide * kSide + 2 * kSide + 2], 0, 0, 0, {1, 0, 0}};
  const CrossingLattice lattice{{1, kSide, kSide * kSide}, kIsovalue, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
  PointRows points(8);
  add_means(lattice, {&row, 1}, 1, 1, points);
  ASSERT_EQ(points.count, 1u);
  EXPECT_GT(points.area_mm2[0], 0.5f);
  EXPECT_EQ(points.normal_x[0], 0.0f);
}

TEST(BrickKernel, BoundContainsAllPointsAndIsTight) {
  std::mt19937 bits(8);
  for (const std::size_t count : {std::size_t{1}, std::size_t{7}, std::size_t{8}, std::size_t{100}}) {
    PointRows points(100);
    for (int n = 0; n < 100; ++n) {
      points.add({static_cast<float>(uniform(bits, -1, 1)), static_cast<float>(uniform(bits, 0, 1)),
                  static_cast<float>(uniform(bits, 2, 3)), 1});
    }
    Vec3 min = points.point(0).position_mm(), max = min;
    for (std::size_t n = 1; n < count; ++n) {
      min = min.cwiseMin(points.point(n).position_mm());
      max = max.cwiseMax(points.point(n).position_mm());
    }
    double max_distance_mm = 0;
    for (std::size_t n = 0; n < count; ++n) {
      max_distance_mm = std::max(max_distance_mm, (points.point(n).position_mm() - 0.5 * (min + max)).norm());
    }
    for (const std::int64_t set : available_instruction_sets(brick_kernel_targets())) {
      const ForcedInstructionSet forced(set);
      const BrickPoints::Bound bound = bound_of(points, count);
      EXPECT_LT((bound.centre() - 0.5 * (min + max)).norm(), 1e-6);
      EXPECT_GE(static_cast<double>(bound.radius_mm), max_distance_mm);
      EXPECT_LE(static_cast<double>(bound.radius_mm), 1.001 * max_distance_mm);
    }
  }
}

TEST(BrickKernel, InstructionsAreChosenBeforeTheTick) {
  const Volume volume = testing_support::shape_volume(testing_support::centred_cube(8, 0.5),
                                                      testing_support::ball(Vec3::Zero(), 1));
  hwy::GetChosenTarget().DeInit();
  const BoneBricks bricks(volume, 0.13);
  EXPECT_TRUE(hwy::GetChosenTarget().IsInitialized());
}

}  // namespace
}  // namespace osteomill
