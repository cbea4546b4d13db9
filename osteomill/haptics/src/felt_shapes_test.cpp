#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "osteomill/haptics/algorithms.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::centred_cube;
using testing_support::shape_volume;

constexpr double kVoxel_mm = 0.25;
constexpr double kDeep_mm = 0.5;

// Describes bone whose surface is a plane, a ball or a ridge at the contact, and the tolerance, in voxels, of
// the felt height for a given width of its edge.
struct Shape {
  struct Allowed {
    double edge_voxels;
    double voxels;
  };
  const char* name;
  std::function<double(const Vec3& p, const Vec3& normal, double offset_mm)> distance_mm;
  std::array<Allowed, 3> allowed;
};
const Shape kShapes[] = {
    {"plane",
     [](const Vec3& p, const Vec3& normal, double offset_mm) { return normal.dot(p) - offset_mm; },
     {{{2, 0.03}, {1, 0.2}, {1e-9, 0.5}}}},
    {"ball",
     [](const Vec3& p, const Vec3& normal, double offset_mm) {
       return (p - (offset_mm - 4) * normal).norm() - 4;
     },
     {{{2, 0.03}, {1, 0.2}, {1e-9, 0.5}}}},
    {"ridge",
     [](const Vec3& p, const Vec3& normal, double offset_mm) {
       const Vec3 side = normal.unitOrthogonal();
       return std::numbers::sqrt2 / 2 * (normal.dot(p) - offset_mm + std::abs(side.dot(p)));
     },
     {{{2, 0.65}, {1, 0.65}, {1e-9, 0.65}}}}};

// Presses the burr by kDeep_mm along the normal, with a coupling of 1 N/mm.
HapticStep pressed(const Volume& bone, const Vec3& normal, double offset_mm) {
  constexpr double kTick_s = 1e-3;
  HapticSettings settings;
  settings.set_option("stiffness", 1);
  const auto algorithm = make_algorithm(default_algorithm(), settings);
  const MillingTool tool;
  algorithm->prepare({&bone, tool, kTick_s});
  HapticStep step;
  for (int n = 0; n < 160; ++n) {
    const double deep_mm = std::min(kDeep_mm, -2 + 0.02 * n);
    const Vec3 position_W = (offset_mm + tool.burr_radius_mm - deep_mm) * normal;
    step = algorithm->step({position_W, smallest_rotation(Vec3::UnitZ(), normal)}, kTick_s);
  }
  return step;
}

// Densities rise from air to bone within two voxels, within one, or, as in a label map, in one step.
TEST(FeltShape, ForceIsIndependentOfVoxelAlignmentWithinTolerance) {
  const auto force_N = [&](const Shape& shape, const Vec3& normal, double offset_mm, double edge_voxels) {
    const Volume bone = shape_volume(
        centred_cube(37, kVoxel_mm), [&](const Vec3& p) { return shape.distance_mm(p, normal, offset_mm); },
        edge_voxels);
    return pressed(bone, normal, offset_mm).wrench.force_N.dot(normal);
  };
  const double plane_N_per_mm = force_N(kShapes[0], Vec3::UnitZ(), 0, 2) / kDeep_mm;
  for (const Shape& shape : kShapes) {
    const double known_N = force_N(shape, Vec3::UnitZ(), 0, 2);
    EXPECT_GT(known_N, 0.01);
    for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 1, 1), Vec3(1, 2, 3)}) {
      for (const double voxels : {0.0, 0.25, 0.5}) {
        for (const auto& [edge_voxels, allowed_voxels] : shape.allowed) {
          const double felt_N = force_N(shape, axis.normalized(), voxels * kVoxel_mm, edge_voxels);
          EXPECT_NEAR(felt_N / plane_N_per_mm, known_N / plane_N_per_mm, allowed_voxels * kVoxel_mm)
              << shape.name << " along " << axis.transpose() << ", " << voxels << " voxels off, an edge of "
              << edge_voxels << " voxels";
        }
      }
    }
  }
}

// The bone around the tool has more points than a tick can build, and the hand does not wait: the tool does.
TEST(FeltShape, ToolStartedInAHoleOfAFineScanStaysInside) {
  constexpr double kHole_mm = 1.6;
  const MillingTool tool;
  const Volume bone = shape_volume(centred_cube(160, 0.08),
                                   [&](const Vec3& p) { return kHole_mm - std::hypot(p.x(), p.y()); });
  for (const Vec3& aside_W : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
    const auto algorithm = make_algorithm(default_algorithm(), HapticSettings{});
    algorithm->prepare({&bone, tool, 1e-3});
    HapticStep step;
    double max_distance_mm = 0;
    for (int n = 0; n < 150; ++n) {
      const Vec3 position_W = std::min(2.5, 0.5 * n) * aside_W - Vec3(0, 0, 6);
      step = algorithm->step({position_W, Quat::Identity()}, 1e-3);
      max_distance_mm = std::max(max_distance_mm, step.X_WT.position_mm.head<2>().norm());
    }
    EXPECT_LT(max_distance_mm, kHole_mm - tool.burr_radius_mm + 0.15) << aside_W.transpose();
    EXPECT_LT(step.wrench.force_N.dot(aside_W), -0.5) << aside_W.transpose();
  }
}

}  // namespace
}  // namespace osteomill
