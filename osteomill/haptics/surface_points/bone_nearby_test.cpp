#include <cmath>
#include <numbers>
#include <random>

#include "tests/shapes.h"
#include <gtest/gtest.h>

#include "osteomill/haptics/surface_points/vertex_springs.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::surface_points {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::shape_volume;

TEST(BoneNearby, NeverOverlooksBoneAndClearsMostOfTheAir) {
  GridGeometry geometry = centred_cube(64, 0.25);
  geometry.direction = quaternion_from_rotation_vector({0.4, 0.2, -0.7}).toRotationMatrix();
  geometry.origin_mm = geometry.direction * geometry.origin_mm;
  // Part of the ball lies beyond the border.
  const Volume volume = shape_volume(geometry, ball(geometry.direction * Vec3(6, 0, 0), 3.5));
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  int air = 0;
  int cleared = 0;
  for (int n = 0; n < 3000; ++n) {
    const Vec3 centre = 11.0 * Vec3(unit(random), unit(random), unit(random));
    const Quat turned = quaternion_from_rotation_vector(3.0 * Vec3(unit(random), unit(random), unit(random)));
    bool bone = false;
    for (int m = 0; m < 64; ++m) {
      const double angle = 2 * std::numbers::pi * m / 16;
      const Vec3 point = centre + turned * ((m / 16 + 1) * 0.25 * Vec3(std::cos(angle), std::sin(angle), 0));
      bone = bone || density_at(volume.grid(), point) > volume.isovalue();
    }
    const bool near = bone_near_disc(volume, centre, turned * Vec3::UnitZ(), 1.0);
    EXPECT_TRUE(near || !bone);
    air += !bone;
    cleared += !near;
  }
  EXPECT_GT(air, 2000);
  EXPECT_GT(cleared, air / 2);
}

}  // namespace
}  // namespace osteomill::surface_points
