#include "osteomill/volume/isovalue.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/volume/builtin_tooth.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::shape_volume;

DensityGrid with_noise(const DensityGrid& grid, double slope, double offset, double sigma) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, sigma);
  std::vector<float> densities;
  for (const float density : every_nth_density(grid, 1)) {
    densities.push_back(
        static_cast<float>(std::round(slope * static_cast<double>(density) + offset + noise(random))));
  }
  return DensityGrid(grid.geometry(), std::move(densities));
}

// Head of soft tissue in air with a skull of bone from 300 up and, optionally, padding outside the field of
// view.
DensityGrid head(double offset, bool padded) {
  const GridGeometry geometry = centred_cube(60, 3);
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0, 25);
  std::uniform_real_distribution<double> bone(300, 1500);
  std::vector<float> densities;
  for (int k = 0; k < 60; ++k) {
    for (int j = 0; j < 60; ++j) {
      for (int i = 0; i < 60; ++i) {
        const Vec3 p = geometry.world_from_voxel(VoxelIndex{i, j, k});
        const double radius_mm = p.norm();
        double density = (radius_mm > 75                     ? -1000
                          : radius_mm > 69 || radius_mm < 60 ? 40
                                                             : bone(random)) +
                         noise(random);
        if (padded && p.head<2>().norm() > 88) density = -2000;
        densities.push_back(static_cast<float>(std::round(density + offset)));
      }
    }
  }
  return DensityGrid(geometry, std::move(densities));
}

// First half of a volume's slices.
DensityGrid first_half(const DensityGrid& grid) {
  GridGeometry geometry = grid.geometry();
  geometry.dims[2] /= 2;
  std::vector<float> densities = every_nth_density(grid, 1);
  densities.resize(geometry.voxel_count());
  return DensityGrid(geometry, std::move(densities));
}

TEST(SuggestIsovalue, IgnoresVoxelsWithoutDensity) {
  for (const double offset : {0.0, 700.0}) {
    const DensityGrid measured = first_half(head(offset, false));
    GridGeometry geometry = measured.geometry();
    geometry.dims[2] *= 2;
    std::vector<float> densities = every_nth_density(measured, 1);
    densities.resize(geometry.voxel_count(), std::numeric_limits<float>::quiet_NaN());
    const DensityGrid grid(geometry, std::move(densities));
    EXPECT_EQ(grid.voxels_without_density(), measured.geometry().voxel_count());
    const SuggestedIsovalue suggested = suggest_isovalue(grid), expected = suggest_isovalue(measured);
    EXPECT_EQ(suggested.value, expected.value);
    EXPECT_EQ(suggested.how, expected.how);
    EXPECT_EQ(every_nth_density(grid, 1), every_nth_density(measured, 1));
    // The histogram samples every seventh voxel.
    double counted = 0;
    for (const float log_count : histogram_of(grid).log_counts) counted += std::expm1(log_count);
    EXPECT_LT(counted, static_cast<double>(measured.geometry().voxel_count()) / 7 + 1);
  }
}

TEST(SuggestIsovalue, LiesHalfwayBetweenBoneAndItsSurroundings) {
  const Volume volume = shape_volume(centred_cube(40, 0.25), ball(Vec3::Zero(), 3));
  for (const double slope : {0.03, 1.0, 7.0}) {
    for (const double offset : {-300.0, 0.0, 5000.0}) {
      const SuggestedIsovalue suggested =
          suggest_isovalue(with_noise(volume.grid(), slope, offset, 20 * slope));
      EXPECT_NEAR(suggested.value, 500 * slope + offset, 25 * slope) << suggested.how;
    }
  }
}

// Neither the share of bone in the volume nor a denser part, such as enamel, biases the isovalue.
TEST(SuggestIsovalue, LiesBetweenAirAndDentineInNoisyBuiltinTooth) {
  EXPECT_NEAR(suggest_isovalue(with_noise(builtin_tooth(0.5), 1, 0, 30)).value, kBuiltinToothIsovalue, 40);
  EXPECT_NEAR(suggest_isovalue(with_noise(builtin_tooth(0.25), 1, 0, 30)).value, kBuiltinToothIsovalue, 40);
}

TEST(SuggestIsovalue, PicksBoneRatherThanSkinInABody) {
  EXPECT_EQ(suggest_isovalue(head(0, false), true).value, kBone_HU);
  EXPECT_EQ(suggest_isovalue(head(0, true), true).value, kBone_HU);
  // Unit not stated, without and with an offset.
  EXPECT_EQ(suggest_isovalue(head(0, false)).value, kBone_HU);
  EXPECT_EQ(suggest_isovalue(head(0, true)).value, kBone_HU);
  EXPECT_NEAR(suggest_isovalue(head(1024, false)).value, 1024 + kBone_HU, 30);
  const auto has_another_zero = [](double offset) {
    return suggest_isovalue(head(offset, false)).how.find("with a different zero") != std::string::npos;
  };
  EXPECT_FALSE(has_another_zero(0));
  EXPECT_TRUE(has_another_zero(1024));
}

TEST(SuggestIsovalue, IsMarkedAsGuessIfThereAreSeveralBoundaries) {
  const Volume outer = shape_volume(centred_cube(40, 0.25), ball(Vec3::Zero(), 4));
  const Volume inner = shape_volume(centred_cube(40, 0.25), ball(Vec3::Zero(), 2.5));
  const auto is_guess = [](const DensityGrid& grid) {
    return suggest_isovalue(grid).how.find("; a guess, with other boundaries at ") != std::string::npos;
  };
  EXPECT_FALSE(is_guess(outer.grid()));
  std::vector<float> both = every_nth_density(outer.grid(), 1);
  const std::vector<float> within = every_nth_density(inner.grid(), 1);
  for (std::size_t n = 0; n < both.size(); ++n) both[n] += 1.5f * within[n];
  const DensityGrid two(outer.geometry(), both);
  EXPECT_TRUE(is_guess(two));
  const SuggestedIsovalue suggested = suggest_isovalue(two);
  ASSERT_EQ(suggested.boundaries.size(), 2u);
  EXPECT_NE(suggested.boundaries[0].is_suggested, suggested.boundaries[1].is_suggested);
}

// Specimen in air without densities near 260 HU: halfway is above 260 and right.
TEST(SuggestIsovalue, IsNeverBelowBoneThresholdInHounsfieldUnits) {
  const Volume volume = shape_volume(centred_cube(40, 0.25), ball(Vec3::Zero(), 3));
  EXPECT_NEAR(suggest_isovalue(with_noise(volume.grid(), 1.5, 0, 30), true).value, 750, 40);
  EXPECT_EQ(suggest_isovalue(with_noise(volume.grid(), 1.8, -1000, 30), true).value, kBone_HU);
}

TEST(SuggestIsovalue, LiesStrictlyInsideTheRangeOrIsTheOnlyDensity) {
  const GridGeometry geometry = centred_cube(2, 1);
  EXPECT_EQ(suggest_isovalue(DensityGrid(geometry, std::vector<float>(8, 7.0f))).value, 7);
  const float next = std::nextafter(1.0f, 2.0f);
  std::mt19937_64 random(9);
  for (const float top : {next, 2.0f, 1000.0f, 1e10f}) {
    const double between =
        suggest_isovalue(DensityGrid(geometry, std::vector<float>{1, 1, 1, 1, 1, 1, 1, top})).value;
    EXPECT_GT(between, 1.0);
    EXPECT_LT(between, static_cast<double>(top));
  }
  for (int n = 0; n < 200; ++n) {
    std::vector<float> densities(27);
    std::uniform_real_distribution<float> any(-1500, n % 2 == 0 ? 300.0f : -500.0f);
    std::generate(densities.begin(), densities.end(), [&] { return any(random); });
    const auto [min, max] = std::minmax_element(densities.begin(), densities.end());
    for (const bool hounsfield : {false, true}) {
      const double value = suggest_isovalue(DensityGrid(centred_cube(3, 1), densities), hounsfield).value;
      EXPECT_GT(value, static_cast<double>(*min));
      EXPECT_LT(value, static_cast<double>(*max));
    }
  }
}

}  // namespace
}  // namespace osteomill
