#include <cmath>
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

TEST(RayCrossing, AgreesWithTheSlowSearch) {
  const Volume volume = shape_volume(centred_cube(48, 0.25), ball({0.3, -0.2, 0.1}, 3.0));
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  int met = 0;
  for (int n = 0; n < 500; ++n) {
    const Vec3 from = 5.0 * Vec3(unit(random), unit(random), unit(random));
    const Vec3 to = 5.0 * Vec3(unit(random), unit(random), unit(random));
    if (density_at(volume.grid(), from) > volume.isovalue()) {
      EXPECT_EQ(marched_spring(volume, to, from), from - to);
      continue;
    }
    const auto slow = first_crossing(volume, from, to);
    const Vec3 spring = marched_spring(volume, to, from);
    ASSERT_EQ(slow.has_value(), spring != Vec3::Zero());
    if (!slow) continue;
    ++met;
    EXPECT_LT((to + spring - *slow).norm(), 1e-3);
  }
  EXPECT_GT(met, 50);
}

// In the finest scans it looks less often than every half voxel.
TEST(RayCrossing, FindsASheetOfAFewFineVoxels) {
  constexpr double kThickness_mm = 0.06;
  const Volume volume = shape_volume(centred_cube(64, 0.02), [](const Vec3& p) {
    return std::abs(Vec3(1, 2, 3).normalized().dot(p)) - 0.5 * kThickness_mm;
  });
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  int met = 0;
  for (int n = 0; n < 500; ++n) {
    const Vec3 from = 0.6 * Vec3(unit(random), unit(random), unit(random));
    const Vec3 to = 0.6 * Vec3(unit(random), unit(random), unit(random));
    const auto slow = first_crossing(volume, from, to);
    if (!slow || density_at(volume.grid(), from) > volume.isovalue()) continue;
    const Vec3 spring = marched_spring(volume, to, from);
    ASSERT_NE(spring, Vec3(Vec3::Zero())) << n;
    ++met;
    EXPECT_LT((to + spring - *slow).norm(), 1e-3);
  }
  EXPECT_GT(met, 100);
}

}  // namespace
}  // namespace osteomill::surface_points
