#include "published/surface_points/surface_points.h"

#include <algorithm>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "osteomill/haptics/sample_points.h"

#include "tests/shapes.h"

namespace osteomill::surface_points {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

constexpr double kDt = 1e-3;
const MillingTool kTool{1.5, 1.0, 25.0};

SurfacePoints prepared(const Volume& volume, const Settings& settings) {
  SurfacePoints algorithm(settings);
  algorithm.prepare({&volume, kTool});
  return algorithm;
}

// Bone below z = 0; its density falls linearly from 5000 at z = -5 to -5000 at z = +5 about the isovalue 0,
// so that the paper's interpolation is exact.
Volume linear_plane() {
  const GridGeometry geometry = centred_cube(41, 0.25);
  std::vector<float> densities;
  for (int k = 0; k < 41; ++k) {
    for (int n = 0; n < 41 * 41; ++n) {
      densities.push_back(static_cast<float>(-1000 * geometry.world_from_voxel(VoxelIndex{0, 0, k}).z()));
    }
  }
  return Volume(DensityGrid(geometry, densities), 0.0);
}

// A burr may be large enough to enclose the whole shaft.
TEST(SurfacePoints, GivesForceButNoTorqueIfTheBurrEnclosesTheShaft) {
  const Volume volume = shape_volume(centred_cube(64, 0.25), plane(Vec3::Zero(), Vec3::UnitZ()));
  SurfacePoints algorithm(Settings{});
  algorithm.prepare({&volume, MillingTool{3, 1, 2}});
  algorithm.step({{0, 0, 3.5}, Quat::Identity()}, kDt);
  const HapticStep pressed = algorithm.step({{0, 0, 2.5}, Quat::Identity()}, kDt);
  EXPECT_GT(pressed.wrench.force_N.z(), 0.1);
  EXPECT_LT(pressed.wrench.torque_Nmm.norm(), 0.1);
}

TEST(SurfacePoints, Equation15SpringSpansFromVertexToSurface) {
  const Volume volume = linear_plane();
  const Vec3 vertex(0.2, 0.1, -0.6);
  const Vec3 centre(0.8, -0.2, 0.9);
  const Vec3 expected = 0.4 * (centre - vertex);
  EXPECT_LT((spring_to_surface(volume, vertex, centre) - expected).norm(), 1e-6);
  EXPECT_EQ(spring_to_surface(volume, centre, vertex), Vec3::Zero());
}

TEST(SurfacePoints, BurrForceMatchesEquations14And16) {
  const Volume volume = linear_plane();
  for (const int vertices : {24, 17, 96}) {
    Settings settings;
    settings.sphere_vertices = vertices;
    auto algorithm = prepared(volume, settings);
    const double height = 0.7;
    const Pose X{{0.3, -0.4, height}, quaternion_from_rotation_vector({0.2, 0.3, 0.5})};
    Vec3 expected = Vec3::Zero();
    int colliding = 0;
    for (const Vec3& vertex : sphere_vertices(kTool, vertices)) {
      const Vec3 arm = X.orientation * vertex;
      const double depth = -(height + arm.z());
      if (depth <= 0) continue;
      ++colliding;
      expected += 20.0 / vertices * (depth / (depth + height)) * -arm;
    }
    const HapticStep step = algorithm.step(X, kDt);
    EXPECT_LT((step.wrench.force_N - expected).norm(), 1e-4);
    EXPECT_LT((step.burr_force_W_N + expected).norm(), 1e-4);
    EXPECT_EQ(step.contacts, colliding);
    EXPECT_GT(colliding, 2);
    EXPECT_EQ(step.wrench.torque_Nmm, Vec3::Zero());
  }
}

// Returns the pose of a tool lying flat above the plane, with its shaft along x of W.
Pose lying(double height) {
  return {{-4, 0, height}, quaternion_from_rotation_vector({0, std::acos(-1.0) / 2, 0})};
}

TEST(SurfacePoints, ShaftTorqueMatchesEquations18To21) {
  const Volume volume = linear_plane();
  for (const int vertices : {8, 13}) {
    Settings settings;
    settings.circle_vertices = vertices;
    auto algorithm = prepared(volume, settings);
    const Pose X = lying(0.8);
    Vec3 expected = Vec3::Zero();
    for (const ShaftSlice& slice : slice_vertices(kTool, 20, vertices)) {
      Vec3 force = Vec3::Zero();
      if ((X * slice.centre_T).x() > 5) continue;  // beyond the bone
      for (const Vec3& vertex : slice.vertices_T) {
        const Vec3 arm = X.orientation * (vertex - slice.centre_T);
        const double depth = -(0.8 + arm.z());
        if (depth > 0) force += 20.0 / vertices * (depth / (depth + 0.8)) * -arm;
      }
      expected += 1.0 / 20 * (X.orientation * slice.centre_T).cross(force);
    }
    const HapticStep step = algorithm.step(X, kDt);
    EXPECT_GT(expected.norm(), 0.5);
    EXPECT_LT((step.wrench.torque_Nmm - expected).norm(), 1e-3 * expected.norm());
  }
}

TEST(SurfacePoints, SamplePointCountFollowsTheVertexSettings) {
  const Volume volume = linear_plane();
  Settings settings;
  const int before = prepared(volume, settings).sample_point_count();
  settings.sphere_vertices = 30;
  EXPECT_EQ(prepared(volume, settings).sample_point_count(), before + 6);
  settings.circle_vertices = 3;
  EXPECT_LT(prepared(volume, settings).sample_point_count(), before / 2);
}

TEST(SurfacePoints, ShaftContactAloneGivesTorqueButNoForce) {
  const Volume volume = shape_volume(centred_cube(48, 0.25), plane(Vec3::Zero(), Vec3::UnitZ()));
  // The burr hangs out beyond the bone.
  const Pose X{{-9, 0, 0.7}, quaternion_from_rotation_vector({0, std::acos(-1.0) / 2, 0})};
  const HapticStep step = prepared(volume, Settings{}).step(X, kDt);
  EXPECT_EQ(step.wrench.force_N, Vec3::Zero());
  EXPECT_EQ(step.burr_force_W_N, Vec3::Zero());
  EXPECT_GT(step.contacts, 0);
  EXPECT_LT(step.wrench.torque_Nmm.y(), -1.0);  // the bone lifts the shaft: +x cross +z
}

TEST(SurfacePoints, HoldsThePreviousForceWhileTheCentreIsInBone) {
  const Volume volume = shape_volume(centred_cube(48, 0.25), plane(Vec3::Zero(), Vec3::UnitZ()));
  auto algorithm = prepared(volume, Settings{});
  const HapticStep before = algorithm.step({{0, 0, 0.3}, Quat::Identity()}, kDt);
  EXPECT_GT(before.wrench.force_N.z(), 3.0);
  for (const double height : {-0.2, -1.0, -3.0}) {
    const HapticStep held = algorithm.step({{0, 0, height}, Quat::Identity()}, kDt);
    EXPECT_EQ(held.wrench.force_N, before.wrench.force_N) << height;
    EXPECT_EQ(held.burr_force_W_N, before.burr_force_W_N);
  }
  const HapticStep after = algorithm.step({{0, 0, 0.3}, Quat::Identity()}, kDt);
  EXPECT_EQ(after.wrench.force_N, before.wrench.force_N);
  EXPECT_EQ(algorithm.step({{0, 0, 3}, Quat::Identity()}, kDt).wrench.force_N, Vec3::Zero());
}

TEST(SurfacePoints, HoldsNoForceIfTheFirstContactIsAlreadyInside) {
  const Volume volume = shape_volume(centred_cube(48, 0.25), plane(Vec3::Zero(), Vec3::UnitZ()));
  auto algorithm = prepared(volume, Settings{});
  const HapticStep first = algorithm.step({{0, 0, -1}, Quat::Identity()}, kDt);
  EXPECT_EQ(first.wrench.force_N, Vec3::Zero());
  EXPECT_GT(first.contacts, 12);
  algorithm.step({{0, 0, 0.3}, Quat::Identity()}, kDt);
  algorithm.reset();
  EXPECT_EQ(algorithm.step({{0, 0, -1}, Quat::Identity()}, kDt).wrench.force_N, Vec3::Zero());
}

TEST(SurfacePoints, ToolPoseEqualsDevicePoseInContact) {
  const Volume volume = shape_volume(centred_cube(48, 0.25), plane(Vec3::Zero(), Vec3::UnitZ()));
  const Pose X{{0.1, 0.2, 0.4}, quaternion_from_rotation_vector({0.1, 0, 0.2})};
  const HapticStep step = prepared(volume, Settings{}).step(X, kDt);
  EXPECT_EQ(step.X_WT.position_mm, X.position_mm);
  EXPECT_EQ(step.X_WT.orientation.coeffs(), X.orientation.coeffs());
}

}  // namespace
}  // namespace osteomill::surface_points
