#include "osteomill/haptics/line_proxy/held_line.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/shapes.h"
#include <gtest/gtest.h>

#include "osteomill/haptics/line_proxy/bone_surface.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::line_proxy {
namespace {

using testing_support::centred_cube;
using testing_support::shape_volume;

constexpr double kTick_s = 1e-3;
constexpr double kVoxel_mm = 0.25;
// Of shape_volume's edge of two voxels.
constexpr double kDensityPerMm = 1000 / (2 * kVoxel_mm);
constexpr ShaftSpan kSpan{0.5, 20, 0.125};
constexpr LineSprings kSprings{2, 3000};

// A block with a hole as milling leaves it: narrow, and with rough walls.
double rough_hole_mm(const Vec3& p) {
  const double rough_mm = 0.12 * std::sin(9 * p.x() + 2 * p.z()) * std::sin(8 * p.y() - 3 * p.z());
  const double void_mm = std::max(p.head<2>().norm() - 1.2, -3 - p.z()) + rough_mm;
  return std::max(p.z() - 3, -void_mm);
}

// How deep the line lies in bone where it is deepest, by closer looks than its own, between which an edge may
// stand out.
double depth_mm(const Volume& bone, const Pose& X_WL) {
  double deepest = 0;
  for (double lever_mm = kSpan.start_mm; lever_mm <= kSpan.end_mm; lever_mm += 0.02) {
    deepest = std::max(deepest, density_at(bone.grid(), X_WL * Vec3(0, 0, lever_mm)) - bone.isovalue());
  }
  return std::max(deepest, density_at(bone.grid(), X_WL.position_mm) - bone.isovalue()) / kDensityPerMm;
}

// What its springs hold, N mm.
double energy_Nmm(const Pose& X_WL, const Pose& X_WD) {
  const ToolMove stretch = move_between(X_WL, X_WD);
  return 0.5 * (kSprings.tip_N_per_mm * stretch.translation_mm.squaredNorm() +
                kSprings.turning_Nmm_per_rad * stretch.rotation_rad.squaredNorm());
}

// Pressed and leant every way in a hole, and held still in between: jammed between two walls too.
TEST(HeldLine, InARoughHoleItIsNeverInBoneNorPushedAgainstItsSprings) {
  const Volume bone = shape_volume(centred_cube(48, kVoxel_mm), rough_hole_mm);
  HeldLine line;
  line.prepare(bone, kSpan, NormalRule{}, kSprings);
  Pose X_WD{Vec3(0, 0, 5), Quat::Identity()};
  line.follow(X_WD, kTick_s);
  int held = 0;
  for (int press = 0; press < 40; ++press) {
    const Vec3 to_W(1.5 * std::sin(2.3 * press), 1.5 * std::cos(3.1 * press), -3.5 + 0.02 * press);
    const Vec3 lean(0.2 * std::cos(1.7 * press), 0.2 * std::sin(2.9 * press), 0);
    const Pose X_W_from = X_WD;
    const ToolMove move = move_between(X_W_from, {to_W, quaternion_from_rotation_vector(lean)});
    for (int n = 1; n <= 100; ++n) {
      X_WD = moved(X_W_from, {0.01 * n * move.translation_mm, 0.01 * n * move.rotation_rad});
      line.follow(X_WD, kTick_s);
      ASSERT_LT(depth_mm(bone, line.X_WL()), 0.02) << press << ", " << n;
    }
    const double held_Nmm = energy_Nmm(line.X_WL(), X_WD);
    if (held_Nmm > 0) ++held;
    for (int n = 0; n < 100; ++n) {
      line.follow(X_WD, kTick_s);
      // Not by more than it climbs over the roughness of the voxels.
      ASSERT_LE(energy_Nmm(line.X_WL(), X_WD), held_Nmm + 0.1 * std::sqrt(held_Nmm)) << press << ", " << n;
    }
  }
  EXPECT_GT(held, 30);
}

// Two voxels thick, met by the tip, by the flank and by the shaft's end, at the speeds of a hand.
TEST(HeldLine, NoSheetOfBoneIsGoneThrough) {
  const Volume bone =
      shape_volume(centred_cube(64, kVoxel_mm), [](const Vec3& p) { return std::abs(p.z()) - 0.25; });
  const Pose tip_first{Vec3(0.1, 0.2, 2), Quat::Identity()};
  const Pose flank_first{Vec3(-5, 0.2, 2), quaternion_from_rotation_vector({0, std::numbers::pi / 2, 0})};
  const Pose end_first{Vec3(0.1, 0.2, 22), quaternion_from_rotation_vector({std::numbers::pi, 0, 0})};
  for (const Pose& from : {tip_first, flank_first, end_first}) {
    for (const double speed_mm_s : {20.0, 100.0, 300.0}) {
      HeldLine line;
      line.prepare(bone, kSpan, NormalRule{}, kSprings);
      Pose X_WD = from;
      for (double way_mm = 0; way_mm < 7; way_mm += speed_mm_s * kTick_s) {
        X_WD.position_mm.z() = from.position_mm.z() - way_mm;
        line.follow(X_WD, kTick_s);
      }
      const double lowest_mm = std::min(line.X_WL().position_mm.z(), (line.X_WL() * Vec3(0, 0, 20)).z());
      EXPECT_GT(lowest_mm, 0) << from.position_mm.z() << " at " << speed_mm_s;
    }
  }
}

}  // namespace
}  // namespace osteomill::line_proxy
