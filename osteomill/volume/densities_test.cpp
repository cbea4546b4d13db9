#include "osteomill/volume/densities.h"

#include <cmath>
#include <fstream>
#include <random>
#include <vector>

#include "tests/shapes.h"
#include "tests/shared_data.h"
#include <gtest/gtest.h>

#include "osteomill/volume/builtin_tooth.h"

namespace osteomill {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::shape_volume;

Volume uniform_volume(float density, double isovalue) {
  const GridGeometry geometry = centred_cube(6, 0.5);
  return Volume(DensityGrid(geometry, std::vector<float>(geometry.voxel_count(), density)), isovalue);
}

// The scan as it was fetched: raw counts of two bytes, the higher first.
Volume real_tooth(double slope = 1, double intercept = 0) {
  GridGeometry geometry;
  geometry.dims = {103, 94, 161};
  geometry.spacing_mm = Vec3::Constant(0.125);
  std::ifstream file(testing_support::shared_data() / "tooth/original/tooth.raw", std::ios::binary);
  std::vector<char> bytes(2 * geometry.voxel_count());
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  std::vector<float> densities;
  for (std::size_t n = 0; n < geometry.voxel_count(); ++n) {
    const int count =
        256 * static_cast<unsigned char>(bytes[2 * n]) + static_cast<unsigned char>(bytes[2 * n + 1]);
    densities.push_back(static_cast<float>(slope * count + intercept));
  }
  return Volume(DensityGrid(geometry, std::move(densities)), slope * 610 + intercept);
}

TEST(EstimateDensities, OfABallAreThoseOfItsTwoSides) {
  const Volume volume = shape_volume(centred_cube(40, 0.25), ball(Vec3::Zero(), 3));
  const BoneDensities densities = estimate_densities(volume);
  EXPECT_EQ(densities.surroundings, 0);
  EXPECT_EQ(densities.reference, 1000);
}

TEST(EstimateDensities, OfTheBuiltinToothAreAirAndDentine) {
  const BoneDensities densities = estimate_densities(Volume(builtin_tooth(), kBuiltinToothIsovalue));
  EXPECT_NEAR(densities.surroundings, 0, 1);
  EXPECT_NEAR(densities.reference, 1500, 1);
}

TEST(EstimateDensities, OfARealToothAreItsMediumAndDentine) {
  OSTEOMILL_NEEDS_SHARED("tooth/original/tooth.raw");
  const BoneDensities counts = estimate_densities(real_tooth());
  EXPECT_NEAR(counts.surroundings, 392, 20);
  EXPECT_NEAR(counts.reference, 825, 25);
  const BoneDensities hounsfield = estimate_densities(real_tooth(3.5, -1380));
  EXPECT_NEAR(hounsfield.surroundings, -8, 70);
  EXPECT_NEAR(hounsfield.reference, 1507, 88);
}

TEST(EstimateDensities, KeepTheirOrderWhateverTheVolume) {
  for (const Volume& volume : {uniform_volume(0, 500), uniform_volume(1000, 500), uniform_volume(500, 500),
                               uniform_volume(0, 0), uniform_volume(-1000, -1500)}) {
    const BoneDensities densities = estimate_densities(volume);
    EXPECT_LT(densities.surroundings, volume.isovalue());
    EXPECT_GT(densities.reference, volume.isovalue());
  }
}

TEST(SuggestIsovalue, LiesMidwayBetweenTwoDensities) {
  const GridGeometry geometry = centred_cube(10, 1);
  std::vector<float> densities(geometry.voxel_count(), -100.0f);
  for (std::size_t n = 0; n < 100; ++n) densities[n] = 300.0f;
  EXPECT_NEAR(suggest_isovalue(DensityGrid(geometry, densities)), 100, 1);
}

TEST(SuggestIsovalue, SeparatesTwoNoisyClassesAsAPlainSearchDoes) {
  const GridGeometry geometry = centred_cube(16, 1);
  std::mt19937_64 random(5);
  std::normal_distribution<float> low(100, 60), high(800, 150);
  std::vector<float> densities;
  for (std::size_t n = 0; n < geometry.voxel_count(); ++n) {
    densities.push_back(n % 5 == 0 ? high(random) : low(random));
  }
  double best = -1, best_threshold = 0;
  for (double threshold = 0; threshold < 900; threshold += 1) {
    double count[2]{}, sum[2]{};
    for (const float density : densities) {
      const int side = static_cast<double>(density) > threshold ? 1 : 0;
      count[side] += 1;
      sum[side] += static_cast<double>(density);
    }
    const double variance = count[0] * count[1] * std::pow(sum[0] / count[0] - sum[1] / count[1], 2);
    if (variance > best) best = variance, best_threshold = threshold;
  }
  EXPECT_NEAR(suggest_isovalue(DensityGrid(geometry, densities)), best_threshold, 5);
}

TEST(SuggestIsovalue, LiesStrictlyInsideTheRangeOrIsTheOnlyDensity) {
  EXPECT_EQ(suggest_isovalue(uniform_volume(7, 0).grid()), 7);
  const GridGeometry geometry = centred_cube(2, 1);
  const float next = std::nextafter(1.0f, 2.0f);
  const double between = suggest_isovalue(DensityGrid(geometry, {1, 1, 1, 1, 1, 1, 1, next}));
  EXPECT_GT(between, 1.0);
  EXPECT_LT(between, static_cast<double>(next));
}

TEST(SuggestIsovalue, OfTeethLiesBetweenAirAndDentine) {
  const double builtin = suggest_isovalue(builtin_tooth(0.5));
  EXPECT_GT(builtin, 300);
  EXPECT_LT(builtin, 1300);
  OSTEOMILL_NEEDS_SHARED("tooth/original/tooth.raw");
  EXPECT_NEAR(suggest_isovalue(real_tooth().grid()), 610, 60);
}

}  // namespace
}  // namespace osteomill
