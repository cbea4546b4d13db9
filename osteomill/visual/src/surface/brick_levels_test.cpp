#include "osteomill/visual/brick_levels.h"

#include <map>

#include <gtest/gtest.h>

#include "osteomill/visual/surface_mesh.h"

#include "tests/shapes.h"
#include "tests/support/mesh_checks.h"

namespace osteomill {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::mesh_of;
using testing_support::mesh_surface;
using testing_support::position_of;
using testing_support::shape_volume;
using testing_support::SurfaceMesh;

// A ball, a thin wall beside it and a drilled hole, over several bricks.
Volume bone() {
  GridGeometry geometry = centred_cube(70, 0.3);
  geometry.direction = quaternion_from_rotation_vector({0.3, -0.2, 0.5}).toRotationMatrix();
  return shape_volume(geometry, [](const Vec3& p) {
    const double solid = std::max(p.norm() - 7, 1.5 - p.head<2>().norm());
    const double wall = std::max(std::abs(p.x() + 8.6) - 0.35, p.norm() - 10);
    return std::min(solid, wall);
  });
}

class BrickLevelsTest : public ::testing::Test {
 protected:
  BrickLevelsTest() {
    for (std::size_t n = 0; n < mesh_.bricks.size(); ++n) {
      levels_.push_back(build_levels(mesh_.bricks[n], bone_.geometry(), mesh_.layout.cells(n)));
    }
  }

  std::size_t triangles(std::size_t level) const {
    std::size_t count = 0;
    for (const BrickLevels& brick : levels_) count += brick.levels[level].count / 3;
    return count;
  }

  const MeshVertex& vertex(std::size_t brick, std::size_t index) const {
    return levels_[brick].vertices[levels_[brick].indices[index]];
  }

  // Difference between the numbers of traversals of each edge in its two directions.
  using Balance = std::map<std::array<std::array<float, 3>, 2>, int>;
  void add(Balance& balance, std::size_t brick, const BrickLevels::Range& range, std::size_t pace) const {
    const auto at = [&](std::size_t n) { return vertex(brick, range.first + n).position_mm; };
    for (std::size_t n = 0; n < range.count; n += pace) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const auto from = at(n + corner);
        const auto to = at(n + (corner + 1) % 3);
        if (from < to) ++balance[{from, to}];
        if (to < from) --balance[{to, from}];
      }
    }
  }
  static std::size_t open_edges(const Balance& balance) {
    return static_cast<std::size_t>(
        std::count_if(balance.begin(), balance.end(), [](const auto& edge) { return edge.second != 0; }));
  }

  Volume bone_ = bone();
  SurfaceMesh mesh_ = mesh_surface(DensityView(bone_));
  std::vector<BrickLevels> levels_;
};

TEST_F(BrickLevelsTest, LevelZeroIsTheMesh) {
  for (std::size_t n = 0; n < levels_.size(); ++n) {
    ASSERT_EQ(mesh_of(levels_[n]), mesh_.bricks[n]);
  }
}

TEST_F(BrickLevelsTest, CoarseLevelsHaveLessThanHalfTheTriangles) {
  EXPECT_LT(triangles(1), triangles(0) / 2);
  EXPECT_LT(triangles(2), triangles(0) / 3);
  EXPECT_LT(triangles(3), triangles(2));
}

// Each brick at a different level.
TEST_F(BrickLevelsTest, BricksOfDifferentLevelsMeetWithoutGaps) {
  Balance balance;
  for (std::size_t n = 0; n < levels_.size(); ++n)
    add(balance, n, levels_[n].levels[(n * 7 + n / 5) % BrickLevels::kCount], 3);
  EXPECT_EQ(open_edges(balance), 0u);
}

// The rim of a plate must not shrink between brick borders.
TEST(BrickLevels, CoarsestLevelKeepsSharpEdgesInPlace) {
  constexpr double kHalf_mm = 7.3, kVoxel_mm = 0.3;
  const Volume plate = shape_volume(centred_cube(60, kVoxel_mm), [&](const Vec3& p) {
    return std::max(p.head<2>().cwiseAbs().maxCoeff() - kHalf_mm, std::abs(p.z()) - 0.6);
  });
  const SurfaceMesh mesh = mesh_surface(DensityView(plate));
  int rims = 0;
  for (std::size_t n = 0; n < mesh.bricks.size(); ++n) {
    const BrickLevels levels = build_levels(mesh.bricks[n], plate.geometry(), mesh.layout.cells(n));
    double outermost_mm = 0;
    for (std::size_t at = 0; at < levels.levels[3].count; ++at) {
      const std::size_t own = mesh.bricks[n].vertices.size();
      const std::size_t index = levels.indices[levels.levels[3].first + at];
      if (index < own) continue;
      const Vec3 p = position_of(levels.vertices[index]);
      if (std::abs(p.y()) < 5) outermost_mm = std::max(outermost_mm, std::abs(p.x()));
    }
    if (outermost_mm < kHalf_mm - 6 * kVoxel_mm) continue;
    ++rims;
    EXPECT_NEAR(outermost_mm, kHalf_mm, 0.5 * kVoxel_mm);
  }
  EXPECT_GT(rims, 3);
}

// The drawn surface stays within a cell's diagonal of the true one.
TEST_F(BrickLevelsTest, CoarseLevelsStayWithinACellDiagonalOfTheMesh) {
  for (std::size_t level = 1; level < BrickLevels::kCount; ++level) {
    const double reach_mm = std::sqrt(3.0) * static_cast<double>(1 << level) * 0.3;
    for (std::size_t n = 0; n < levels_.size(); ++n) {
      const BrickLevels::Range& range = levels_[n].levels[level];
      for (std::size_t at = range.first; at < range.first + range.count; at += 3) {
        Vec3 middle = Vec3::Zero();
        for (std::size_t corner = 0; corner < 3; ++corner) middle += position_of(vertex(n, at + corner)) / 3;
        double nearest_mm = reach_mm + 1;
        for (const MeshVertex& own : mesh_.bricks[n].vertices)
          nearest_mm = std::min(nearest_mm, (position_of(own) - middle).norm());
        ASSERT_LT(nearest_mm, reach_mm);
      }
    }
  }
}

}  // namespace
}  // namespace osteomill
