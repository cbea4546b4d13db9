#include "published/point_shell/contacts.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "published/point_shell/virtual_coupling.h"
#include "tests/random.h"
#include "tests/shapes.h"
#include "tests/support/every_point.h"

namespace osteomill::point_shell {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::plane;
using testing_support::random_vector;
using testing_support::shape_volume;
using testing_support::uniform;

const MillingTool kTool{1.5, 1.0, 25.0};

constexpr double kStiffness_N_per_mm3 = 20;
Vec3 force_of(const EnergySum& sum) {
  return -sum.gradient.head<3>();
}
Vec3 torque_of(const EnergySum& sum) {
  return -sum.gradient.tail<3>();
}
Mat3 K_ff(const EnergySum& sum) {
  return sum.convex.topLeftCorner<3, 3>();
}
Mat3 K_ft(const EnergySum& sum) {
  return sum.convex.topRightCorner<3, 3>();
}
Mat3 K_tt(const EnergySum& sum) {
  return sum.convex.bottomRightCorner<3, 3>();
}

SampledDistanceField sampled(const MillingTool& tool) {
  return SampledDistanceField(tool, SampledDistanceField::suitable_spacing_mm(tool));
}

// Brute-force reference: tests every point of the shell.
ToolContacts contacts_by_brute_force(const VoxelShell& shell, const SampledDistanceField& field,
                                     const Pose& X_WT) {
  ToolContacts contacts;
  const Mat3 R_WT = X_WT.orientation.toRotationMatrix();
  for_each_point(shell, [&](const Vec3& point_W, double area) {
    const Vec3 point_T = X_WT.inverse() * point_W;
    const auto distance = field.at(point_T);
    if (!distance || !(distance->distance_mm < 0)) return;
    const double k = kStiffness_N_per_mm3 * area;
    add_contact(point_T.z() < burr_top_mm(kTool) ? contacts.burr : contacts.shaft, -k * distance->distance_mm,
                k, R_WT * distance->outward_T, point_W - X_WT.position_mm);
  });
  return contacts;
}

void expect_near(const EnergySum& a, const EnergySum& b, double relative) {
  const double tiny = 1e-9;
  EXPECT_LE((force_of(a) - force_of(b)).norm(), relative * force_of(b).norm() + tiny);
  EXPECT_LE((torque_of(a) - torque_of(b)).norm(), relative * torque_of(b).norm() + tiny);
  EXPECT_LE((K_ff(a) - K_ff(b)).norm(), relative * K_ff(b).norm() + tiny);
  EXPECT_LE((K_ft(a) - K_ft(b)).norm(), relative * K_tt(b).norm() + tiny);
  EXPECT_LE((K_tt(a) - K_tt(b)).norm(), relative * K_tt(b).norm() + tiny);
}

Pose random_pose(std::mt19937& bits, double reach_mm) {
  const Vec3 position = reach_mm * random_vector(bits);
  return {position, quaternion_from_rotation_vector(3 * random_vector(bits))};
}

GridGeometry turned_cube(int voxels, double spacing_mm) {
  GridGeometry geometry = centred_cube(voxels, spacing_mm);
  geometry.direction = quaternion_from_rotation_vector({0.3, 0.5, -0.7}).toRotationMatrix();
  geometry.origin_mm = geometry.direction * geometry.origin_mm;
  return geometry;
}

TEST(OctreeContacts, MatchBruteForceOverEveryPoint) {
  std::mt19937 bits(5);
  const Volume volume = shape_volume(turned_cube(60, 0.2), ball({0.3, 0.1, 0}, 5));
  const SampledDistanceField field = sampled(kTool);
  for (const int scale : {1, 3}) {
    const VoxelShell shell(volume, scale);
    int touched = 0;
    for (int n = 0; n < 150; ++n) {
      const Pose X_WT = random_pose(bits, 7);
      const ToolContacts by_octree = contacts_by_octree(shell, kTool, field, X_WT, kStiffness_N_per_mm3);
      const ToolContacts by_all = contacts_by_brute_force(shell, field, X_WT);
      EXPECT_EQ(by_octree.total().touching, by_all.total().touching);
      expect_near(by_octree.burr, by_all.burr, 1e-9);
      expect_near(by_octree.shaft, by_all.shaft, 1e-9);
      touched += by_all.total().touching > 0 ? 1 : 0;
    }
    EXPECT_GT(touched, 50);
  }
}

// Force along the normal over kA pi (r - d) d^2: minimum and maximum while sliding over a plane.
struct PlaneRatios {
  double min = 1e9;
  double max = 0;
  double sideways = 0;
};

// `contacts(volume)` returns a function from a pose to its contacts.
template <typename Contacts>
PlaneRatios slide_over_plane(const Contacts& contacts, const Vec3& normal, double depth_mm,
                             double edge_voxels) {
  const Vec3 n = normal.normalized(), through(0.01, 0.02, -0.03);
  const Volume volume = shape_volume(centred_cube(48, 0.125), plane(through, n), edge_voxels);
  auto contacts_at = contacts(volume);
  PlaneRatios ratios;
  for (int step = 0; step < 60; ++step) {
    const Vec3 along = (0.016 * step - 0.5) * n.unitOrthogonal() + 0.003 * step * n.cross(n.unitOrthogonal());
    const Pose X_WT{through + along + (1.5 - depth_mm) * n, smallest_rotation(Vec3::UnitZ(), n)};
    const Vec3 force = force_of(contacts_at(X_WT).total());
    const double ratio = force.dot(n) / (20 * std::numbers::pi * (1.5 - depth_mm) * depth_mm * depth_mm);
    ratios.min = std::min(ratios.min, ratio);
    ratios.max = std::max(ratios.max, ratio);
    ratios.sideways = std::max(ratios.sideways, force.cross(n).norm() / force.norm());
  }
  return ratios;
}

auto voxel_centres(int scale) {
  return [scale](const Volume& volume) {
    return [shell = VoxelShell(volume, scale), field = sampled(kTool)](const Pose& X_WT) {
      return contacts_by_octree(shell, kTool, field, X_WT, kStiffness_N_per_mm3);
    };
  };
}

const std::vector<Vec3> kNormals{{0, 0, 1},     {1, 0, 0},  {1, 1, 0},      {1, 1, 1},         {1, 2, 3},
                                 {0.05, 0, -1}, {3, -2, 1}, {-0.4, 0.9, 2}, {0.37, 0.61, -0.2}};

// With the paper's method the centres lie half a voxel and more inside the bone, and are sparser on slopes.
TEST(PlaneContact, ForceOfPublishedMethodIsTooLowDependingOnSlope) {
  const PlaneRatios straight = slide_over_plane(voxel_centres(1), {0, 0, 1}, 0.25, 2);
  EXPECT_NEAR(straight.min, 0.78, 0.04);
  EXPECT_NEAR(straight.max, 0.78, 0.04);
  const PlaneRatios diagonal = slide_over_plane(voxel_centres(1), {1, 1, 1}, 0.25, 2);
  EXPECT_NEAR(diagonal.min, 0.43, 0.04);
  EXPECT_NEAR(diagonal.max, 0.43, 0.04);
  const PlaneRatios coarse = slide_over_plane(voxel_centres(3), {1, 1, 1}, 0.125, 2);
  EXPECT_LT(coarse.min, 0.02);
}

// Force between two spheres: kA times the integral of (r - |p - c|) cos(turn) over the cap of the bone ball,
// where p is at an angle t off the line of centres. Integrated numerically on a fine grid.
double ball_force(double bone_radius, double burr_radius, double between) {
  double sum = 0;
  const int steps = 4000;
  for (int n = 0; n < steps; ++n) {
    const double t = 0.5 * (n + 0.5) / steps;
    const double along = between - bone_radius * std::cos(t), across = bone_radius * std::sin(t);
    const double distance = std::hypot(along, across);
    if (distance >= burr_radius) break;
    sum += (burr_radius - distance) * along / distance * 2 * std::numbers::pi * bone_radius * bone_radius *
           std::sin(t) * 0.5 / steps;
  }
  return sum;
}

TEST(BallContact, ForceOfPublishedMethodIsTooLowButPointsOutward) {
  std::mt19937 bits(10);
  const Volume volume = shape_volume(centred_cube(72, 0.125), ball({0, 0, 0}, 4));
  const VoxelShell shell(volume, 1);
  const SampledDistanceField field = sampled(kTool);
  for (int n = 0; n < 100; ++n) {
    const Vec3 direction = random_vector(bits).normalized();
    const Pose X_WT{5.1 * direction, smallest_rotation(Vec3::UnitZ(), direction)};
    const EnergySum sum = contacts_by_octree(shell, kTool, field, X_WT, kStiffness_N_per_mm3).total();
    const double ratio = force_of(sum).dot(direction) / (20 * ball_force(4, 1.5, 5.1));
    EXPECT_GT(ratio, 0.4);
    EXPECT_LT(ratio, 0.95);
    EXPECT_LT(force_of(sum).cross(direction).norm() / force_of(sum).norm(), 0.1);
  }
}

// For a single point, the derivative of its depth in the tool is n . dx + (r x n) . dw.
TEST(ContactSum, DepthDerivativeIsNormalAndLeverCrossNormal) {
  std::mt19937 bits(21);
  int tested = 0;
  for (int n = 0; n < 300; ++n) {
    const Pose X_WT = random_pose(bits, 3);
    const Vec3 p_T(uniform(bits, -1.4, 1.4), uniform(bits, -1.4, 1.4), uniform(bits, -1.4, 20));
    const ToolDistance here = tool_distance(kTool, p_T);
    if (here.distance_mm > -0.02 || here.distance_mm < -0.4) continue;
    const Vec3 point_W = X_WT * p_T;
    const auto depth = [&](const ToolMove& move) {
      return -tool_distance(kTool, moved(X_WT, move).inverse() * point_W).distance_mm;
    };
    const Vec3 normal_W = X_WT.orientation * here.outward_T;
    const Vec3 r = point_W - X_WT.position_mm;
    constexpr double kStep = 1e-5;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 e = kStep * Vec3::Unit(axis);
      EXPECT_NEAR((depth({e, Vec3::Zero()}) - depth({-e, Vec3::Zero()})) / (2 * kStep), normal_W[axis], 1e-6);
      EXPECT_NEAR((depth({Vec3::Zero(), e}) - depth({Vec3::Zero(), -e})) / (2 * kStep),
                  r.cross(normal_W)[axis], 1e-4);
    }
    ++tested;
  }
  EXPECT_GT(tested, 30);
}

// Compares the derivative of the whole sum with differences of the force. On the burr the omitted term has a
// closed form: a point at distance s from the centre adds k depth / s (1 - n n^T) to the force's derivative.
TEST(ContactSum, ForceDerivativeOmitsOnlyTheRotationOfNormals) {
  const Volume volume = shape_volume(centred_cube(64, 0.125), ball({0, 0, -2.5}, 3));
  const VoxelShell shell(volume, 1);
  const SampledDistanceField field = sampled(kTool);
  const auto contacts_at = [&](const Pose& X_WT) {
    return contacts_by_octree(shell, kTool, field, X_WT, kStiffness_N_per_mm3).total();
  };
  const Pose X_WT{{0.2, 0.1, 1.7}, quaternion_from_rotation_vector({0.3, 0.2, 0})};
  const EnergySum here = contacts_at(X_WT);
  Mat3 left_out = Mat3::Zero();
  for_each_point(shell, [&](const Vec3& point_W, double area) {
    const Vec3 r = point_W - X_WT.position_mm;
    const double s = r.norm(), depth = 1.5 - s;
    if (!(depth > 0)) return;
    const Vec3 n = r / s;
    left_out += kStiffness_N_per_mm3 * area * depth / s * (Mat3::Identity() - n * n.transpose());
  });
  Mat3 differences;
  constexpr double kStep = 1e-4;
  for (int axis = 0; axis < 3; ++axis) {
    const auto force_at = [&](double step) {
      return force_of(contacts_at({X_WT.position_mm + step * Vec3::Unit(axis), X_WT.orientation}));
    };
    differences.col(axis) = (force_at(kStep) - force_at(-kStep)) / (2 * kStep);
  }
  EXPECT_GT(left_out.norm(), 1);
  EXPECT_GT(K_ff(here).norm(), 4 * left_out.norm());
  EXPECT_LT((differences - (left_out - K_ff(here))).norm(), 2e-2 * K_ff(here).norm());
}

}  // namespace
}  // namespace osteomill::point_shell
