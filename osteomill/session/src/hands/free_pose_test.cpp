#include <gtest/gtest.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/haptics/milling_tool.h"
#include "osteomill/session/milling_entry.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::centred_cube;
using testing_support::shape_volume;

// Returns the minimum distance from the tool to bone, computed voxel by voxel.
double room_mm(const Volume& volume, const MillingTool& tool, const Pose& X_WT) {
  double least = 1e9;
  const auto& dims = volume.geometry().dims;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i)
        if (volume.is_bone({i, j, k})) {
          const Vec3 point_W = volume.geometry().world_from_voxel(VoxelIndex{i, j, k});
          least = std::min(least, tool_distance(tool, X_WT.inverse() * point_W).distance_mm);
        }
  return least;
}

void expect_free(const Volume& volume, const Vec3& point_W, const Vec3& towards_W, const Vec3& up_W) {
  const MillingTool tool;
  const Pose X_WT = free_pose_before(volume, tool, point_W, towards_W, up_W);
  EXPECT_GT(room_mm(volume, tool, X_WT), 0.8);
  const Vec3 way = X_WT.position_mm - point_W;
  EXPECT_GE(way.dot(towards_W), tool.burr_radius_mm + 2.9);
  EXPECT_LT(way.cross(towards_W).norm(), 1e-9);
  EXPECT_GE((X_WT.orientation * Vec3::UnitZ()).dot(towards_W), 0.5);
}

TEST(FreePose, IsThreeMillimetresBeforeABallWithTheShaftTiltedUp) {
  const Volume bone = shape_volume(centred_cube(41, 0.5), testing_support::ball(Vec3::Zero(), 6));
  expect_free(bone, {0, -6, 0}, -Vec3::UnitY(), Vec3::UnitZ());
  const Pose X_WT = free_pose_before(bone, {}, {0, -6, 0}, -Vec3::UnitY(), Vec3::UnitZ());
  EXPECT_NEAR(X_WT.position_mm.y(), -6 - 3 - MillingTool{}.burr_radius_mm, 1e-9);
  EXPECT_GT((X_WT.orientation * Vec3::UnitZ()).z(), 0.3);
}

// For a point at the bottom of a narrow hole, the tool is in front of the hole or straight in it.
TEST(FreePose, IsClearOfBoneForPointsInNarrowAndWideHoles) {
  for (const double radius_mm : {2.0, 3.0, 6.0}) {
    const Volume bone = shape_volume(centred_cube(61, 0.4), [&](const Vec3& p) {
      const double block = p.cwiseAbs().maxCoeff() - 11;
      const double hole = std::max(std::hypot(p.x(), p.y()) - radius_mm, -p.z());
      return std::max(block, -hole);
    });
    expect_free(bone, Vec3::Zero(), Vec3::UnitZ(), Vec3::UnitY());
  }
}

TEST(FreePose, GivesZeroForceWithEveryAlgorithm) {
  const Volume bone = shape_volume(centred_cube(41, 0.5), testing_support::ball(Vec3::Zero(), 6));
  const Pose X_WT = free_pose_before(bone, {}, {0, -6, 0}, -Vec3::UnitY(), Vec3::UnitZ());
  for (const AlgorithmDescription& description : all_algorithms()) {
    const auto algorithm = make_algorithm(description, {});
    algorithm->prepare({&bone, {}});
    EXPECT_EQ(algorithm->step(X_WT, 1e-3).wrench.force_N.norm(), 0) << description.id.name;
  }
}

}  // namespace
}  // namespace osteomill
