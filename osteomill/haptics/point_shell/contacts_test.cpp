#include "osteomill/haptics/point_shell/contacts.h"

#include <cmath>
#include <numbers>
#include <random>

#include "tests/instruction_sets.h"
#include "tests/random.h"
#include "tests/shapes.h"
#include "tests/support/every_point.h"
#include <gtest/gtest.h>

#include "osteomill/haptics/bone_points/near_kernel.h"
#include "osteomill/haptics/bone_points/tool_from_grid.h"
#include "osteomill/haptics/point_shell/virtual_coupling.h"

namespace osteomill::point_shell {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::ForcedInstructionSet;
using testing_support::instruction_sets_here;
using testing_support::plane;
using testing_support::random_vector;
using testing_support::shape_volume;
using testing_support::uniform;

const MillingTool kTool{1.5, 1.0, 25.0};

constexpr double kStiffness_N_per_mm3 = 20;
constexpr Penalty kOfPoints{kStiffness_N_per_mm3, 0};
// Patches of two cells' areas at most, as the algorithm has it.
Penalty of_patches(const BoneBricks& bricks) {
  return {20, 2 * bricks.lattice().cell_area_mm2()};
}

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

ToolContacts by_bricks(BoneBricks& bricks, const MillingTool& tool, const Pose& X_WT,
                       const Penalty& penalty) {
  static NearBone near(32768, NearBone::PointsMeet::the_nearest_part);
  return contacts_by_bricks(bricks, near, tool, X_WT, penalty);
}

SampledDistanceField sampled(const MillingTool& tool) {
  return SampledDistanceField(tool, SampledDistanceField::suitable_spacing_mm(tool));
}

BoneBricks fine_bricks(const Volume& volume, double spacing_mm = BoneBricks::kSpacing_mm) {
  return BoneBricks(volume, spacing_mm, BoneBricks::Points::fine);
}

// The slow plain answers: every point of the shell.
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

// Of the isosurface's points, each pushed at the part of the tool that it is nearest to; and what they push
// with if none pushes against another, and one of them at most.
struct OneByOne {
  ToolContacts contacts;
  double force_N = 0, most_N = 0;
  double stiffness_N_per_mm = 0, most_N_per_mm = 0;
};
OneByOne contacts_one_by_one(BoneBricks& bricks, const MillingTool& tool, const Pose& X_WT,
                             const Penalty& penalty) {
  OneByOne found;
  for_each_point(bricks, bricks.fine(), [&](const ShellPoint& point, const Vec3& origin_G) {
    const ToolFromGrid X_TG(bricks.lattice(), X_WT);
    const Vec3 point_T = X_TG * (origin_G + point.position_mm());
    const ToolDistance distance = tool_distance(tool, point_T);
    const bool on_ball = std::abs(distance.distance_mm - (point_T.norm() - tool.burr_radius_mm)) < 1e-12;
    const Penalty::Push push = penalty.push(-distance.distance_mm, static_cast<double>(point.area_mm2),
                                            distance.outward_T.dot(X_TG.turn * point.normal()),
                                            on_ball ? 2 / tool.burr_radius_mm : 1 / tool.shaft_radius_mm);
    if (!(push.force_N > 0)) return;
    add_contact(on_ball ? found.contacts.burr : found.contacts.shaft, push.force_N, push.stiffness_N_per_mm,
                X_WT.orientation * distance.outward_T, X_WT.orientation * point_T);
    found.force_N += push.force_N;
    found.stiffness_N_per_mm += push.stiffness_N_per_mm;
    found.most_N = std::max(found.most_N, push.force_N);
    found.most_N_per_mm = std::max(found.most_N_per_mm, push.stiffness_N_per_mm);
  });
  return found;
}

// To the rounding of single precision; where two parts are equally near, a point's push may be either's.
void expect_near(const ToolContacts& fast, const OneByOne& plain, const MillingTool& tool) {
  EXPECT_NEAR(fast.total().touching, plain.contacts.total().touching,
              1 + 0.01 * plain.contacts.total().touching);
  const EnergySum a = fast.total(), b = plain.contacts.total();
  const double force = 1e-3 * plain.force_N + 2 * plain.most_N, lever_mm = tool.shaft_length_mm;
  const double stiffness = 1e-3 * plain.stiffness_N_per_mm + 2 * plain.most_N_per_mm;
  EXPECT_LE((force_of(a) - force_of(b)).norm(), force);
  EXPECT_LE((force_of(fast.burr) - force_of(plain.contacts.burr)).norm(), force);
  EXPECT_LE((torque_of(a) - torque_of(b)).norm(), lever_mm * force);
  EXPECT_LE((K_ff(a) - K_ff(b)).norm(), stiffness);
  EXPECT_LE((K_ft(a) - K_ft(b)).norm(), lever_mm * stiffness);
  EXPECT_LE((K_tt(a) - K_tt(b)).norm(), lever_mm * lever_mm * stiffness);
}

bool same_bits(const EnergySum& a, const EnergySum& b) {
  return a.gradient == b.gradient && a.convex == b.convex;
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

TEST(OctreeContacts, FindsWhatLookingAtEveryPointFinds) {
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

TEST(BrickContacts, AreThePointsOneByOneAndTheSameBitsWithEveryInstructionSet) {
  std::mt19937 bits(6);
  int touched = 0;
  // A ball with a hole in which the shaft is sleeved, and one that has been milled at random.
  const auto sleeve = [](const Vec3& p) {
    return std::max(p.norm() - 5, -std::max(std::hypot(p.x(), p.y()) - 0.97, -3 - p.z()));
  };
  for (const MillingTool& tool :
       {kTool, MillingTool{0.8, 1.2, 6}, MillingTool{2, 0.5, 12}, MillingTool{0.7, 0.7, 1.5}}) {
    Volume volume = shape_volume(turned_cube(60, 0.2), sleeve);
    for (const double spacing_mm : {0.13, 0.39}) {
      BoneBricks bricks = fine_bricks(volume, spacing_mm);
      for (int n = 0; n < 30; ++n) {
        VoxelBox changed;
        for (int m = 0; m < 5; ++m) {
          const VoxelIndex v{static_cast<int>(bits() % 60), static_cast<int>(bits() % 60),
                             static_cast<int>(bits() % 60)};
          volume.lower_density(v, 0.3f * volume.grid()[v]);
          changed.include(v);
        }
        bricks.refresh(changed);
        const Pose X_WT = n % 4 == 0
                              ? Pose{{0.02, 0.03, -2}, quaternion_from_rotation_vector({0.01, 0.02, 0})}
                              : random_pose(bits, 6);
        for (const Penalty& penalty : {kOfPoints, of_patches(bricks)}) {
          const ToolContacts fast = by_bricks(bricks, tool, X_WT, penalty);
          expect_near(fast, contacts_one_by_one(bricks, tool, X_WT, penalty), tool);
          touched += fast.total().touching;
          if (n > 9) continue;
          for (const std::int64_t target : instruction_sets_here(near_kernel_targets())) {
            const ForcedInstructionSet forced(target);
            const ToolContacts same = by_bricks(bricks, tool, X_WT, penalty);
            EXPECT_EQ(same.total().touching, fast.total().touching) << hwy::TargetName(target);
            EXPECT_TRUE(same_bits(same.burr, fast.burr)) << hwy::TargetName(target);
            EXPECT_TRUE(same_bits(same.shaft, fast.shaft)) << hwy::TargetName(target);
          }
        }
      }
    }
  }
  EXPECT_GT(touched, 10000);
}

// Force along the normal over kA pi (r - d) d^2, least and greatest of a slide over a plane.
struct PlaneRatios {
  double min = 1e9;
  double max = 0;
  double sideways = 0;
};

// `contacts(volume)` makes what gives the contacts at a pose.
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

auto surface_points_apart(double spacing_mm) {
  return [spacing_mm](const Volume& volume) {
    return [bricks = fine_bricks(volume, spacing_mm)](const Pose& X_WT) mutable {
      return by_bricks(bricks, kTool, X_WT, of_patches(bricks));
    };
  };
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

TEST(PlaneContact, SteadyIsTheAnalyticForceInEveryDirection) {
  for (const Vec3& normal : kNormals) {
    for (const double depth_mm : {0.125, 0.2, 0.4}) {
      const PlaneRatios r = slide_over_plane(surface_points_apart(0.13), normal, depth_mm, 2);
      EXPECT_GT(r.min, 0.97) << normal.transpose() << " at " << depth_mm;
      EXPECT_LT(r.max, 1.02) << normal.transpose() << " at " << depth_mm;
      EXPECT_LT((r.max - r.min) / 2, 0.015);
      EXPECT_LT(r.sideways, 0.01);
    }
  }
}

TEST(PlaneContact, SteadyHoldsWithPointsFartherApartAndOnOtherEdges) {
  for (const Vec3& normal : kNormals) {
    const PlaneRatios coarse = slide_over_plane(surface_points_apart(0.5), normal, 0.375, 2);
    EXPECT_GT(coarse.min, 0.95) << normal.transpose();
    EXPECT_LT(coarse.max, 1.05) << normal.transpose();
    const PlaneRatios wide = slide_over_plane(surface_points_apart(0.13), normal, 0.25, 4);
    EXPECT_GT(wide.min, 0.98) << normal.transpose();
    EXPECT_LT(wide.max, 1.02) << normal.transpose();
  }
  // An edge one voxel wide puts the isosurface itself up to 0.09 voxel off the plane where it follows an
  // axis.
  for (const Vec3& normal : {Vec3(1, 1, 0), Vec3(1, 1, 1), Vec3(1, 2, 3), Vec3(3, -2, 1)}) {
    const PlaneRatios sharp = slide_over_plane(surface_points_apart(0.13), normal, 0.25, 1);
    EXPECT_GT(sharp.min, 0.96) << normal.transpose();
    EXPECT_LT(sharp.max, 1.04) << normal.transpose();
  }
}

// What the paper's way gives: centres lie inside the bone, half a voxel and more, and are fewer where it
// slopes.
TEST(PlaneContact, PaperIsTooSoftByASlopeDependentPart) {
  const PlaneRatios straight = slide_over_plane(voxel_centres(1), {0, 0, 1}, 0.25, 2);
  EXPECT_NEAR(straight.min, 0.78, 0.04);
  EXPECT_NEAR(straight.max, 0.78, 0.04);
  const PlaneRatios diagonal = slide_over_plane(voxel_centres(1), {1, 1, 1}, 0.25, 2);
  EXPECT_NEAR(diagonal.min, 0.43, 0.04);
  EXPECT_NEAR(diagonal.max, 0.43, 0.04);
  const PlaneRatios coarse = slide_over_plane(voxel_centres(3), {1, 1, 1}, 0.125, 2);
  EXPECT_LT(coarse.min, 0.02);
}

// Two spheres: the depth at an angle t off the line of centres integrates to
// kA * integral over the cap of the bone ball of (r - |p - c|) cos(turn), done here numerically on a fine
// grid.
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

TEST(BallContact, SteadyIsTheIntegralOverTheBall) {
  std::mt19937 bits(9);
  const Volume volume = shape_volume(centred_cube(72, 0.125), ball({0, 0, 0}, 4));
  BoneBricks bricks = fine_bricks(volume);
  for (int n = 0; n < 100; ++n) {
    const Vec3 direction = random_vector(bits).normalized();
    const double depth_mm = uniform(bits, 0.15, 0.5);
    const Pose X_WT{(5.5 - depth_mm) * direction, smallest_rotation(Vec3::UnitZ(), direction)};
    const EnergySum sum = by_bricks(bricks, kTool, X_WT, of_patches(bricks)).total();
    const double expected = 20 * ball_force(4, 1.5, 5.5 - depth_mm);
    EXPECT_NEAR(force_of(sum).dot(direction) / expected, 1, 0.035);
    EXPECT_LT(force_of(sum).cross(direction).norm() / force_of(sum).norm(), 0.015);
    EXPECT_LT(torque_of(sum).norm(), 1e-9 * force_of(sum).norm());
  }
}

TEST(BallContact, PaperIsSofterButPushesOutwards) {
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

// One point, by itself: the derivative of its depth in the tool is n . dx + (r x n) . dw.
TEST(ContactSum, ADerivativeRowIsTheDepthsOwn) {
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

// The whole sum against differences of the force. On the burr the term left out has a closed form: for a
// point at the distance s from the centre, k depth / s (1 - n n^T) adds to the derivative of the force.
TEST(ContactSum, TheDerivativeOfTheForceLacksOnlyTheTurningOfTheNormals) {
  const Volume volume = shape_volume(centred_cube(64, 0.125), ball({0, 0, -2.5}, 3));
  BoneBricks bricks = fine_bricks(volume);
  const Pose X_WT{{0.2, 0.1, 1.7}, quaternion_from_rotation_vector({0.3, 0.2, 0})};
  const EnergySum here = by_bricks(bricks, kTool, X_WT, kOfPoints).total();
  Mat3 left_out = Mat3::Zero();
  for_each_point(bricks, [&](const Vec3& point_W, double area) {
    const Vec3 r = point_W - X_WT.position_mm;
    const double s = r.norm(), depth = 1.5 - s;
    if (!(depth > 0)) return;
    const Vec3 n = r / s;
    left_out += kOfPoints.stiffness_N_per_mm3 * area * depth / s * (Mat3::Identity() - n * n.transpose());
  });
  Mat3 differences;
  constexpr double kStep = 1e-4;
  for (int axis = 0; axis < 3; ++axis) {
    const auto force_at = [&](double step) {
      const Pose shifted{X_WT.position_mm + step * Vec3::Unit(axis), X_WT.orientation};
      return force_of(by_bricks(bricks, kTool, shifted, kOfPoints).total());
    };
    differences.col(axis) = (force_at(kStep) - force_at(-kStep)) / (2 * kStep);
  }
  EXPECT_GT(left_out.norm(), 1);
  EXPECT_GT(K_ff(here).norm(), 4 * left_out.norm());
  EXPECT_LT((differences - (left_out - K_ff(here))).norm(), 5e-3 * K_ff(here).norm());
}

// The same for the shaft's side, where turning the tool matters: differences of force and torque over small
// turns approach -K as the depth goes to zero, the term left out being proportional to it.
TEST(ContactSum, OnTheShaftTheLeftOutTermVanishesWithTheDepth) {
  const Volume volume = shape_volume(centred_cube(80, 0.1), plane({0, 0, 0.02}, {0, 0, 1}));
  BoneBricks bricks = fine_bricks(volume);
  const auto relative_error = [&](double depth_mm) {
    // The burr hangs free beyond the plane's border; the shaft lies along x.
    const Pose X_WT{{-6, 0, 1.02 - depth_mm}, smallest_rotation(Vec3::UnitZ(), Vec3::UnitX())};
    const EnergySum here = by_bricks(bricks, kTool, X_WT, kOfPoints).total();
    Mat3 differences;
    constexpr double kStep = 1e-4;
    for (int axis = 0; axis < 3; ++axis) {
      const auto torque_at = [&](double step) {
        const Pose turned = moved(X_WT, {Vec3::Zero(), step * Vec3::Unit(axis)});
        return torque_of(by_bricks(bricks, kTool, turned, kOfPoints).total());
      };
      differences.col(axis) = (torque_at(kStep) - torque_at(-kStep)) / (2 * kStep);
    }
    return (differences + K_tt(here)).norm() / K_tt(here).norm();
  };
  const double deep = relative_error(0.2), shallow = relative_error(0.05);
  EXPECT_LT(deep, 0.25);
  EXPECT_LT(shallow, 0.4 * deep);
}

}  // namespace
}  // namespace osteomill::point_shell
