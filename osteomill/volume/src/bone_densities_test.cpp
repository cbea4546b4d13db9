#include "osteomill/volume/bone_densities.h"

#include <fstream>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/volume/builtin_tooth.h"

#include "tests/shapes.h"
#include "tests/shared_data.h"

namespace osteomill {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::shape_volume;

Volume uniform_volume(float density, double isovalue) {
  const GridGeometry geometry = centred_cube(6, 0.5);
  return Volume(DensityGrid(geometry, std::vector<float>(geometry.voxel_count(), density)), isovalue);
}

// Scan as downloaded: raw 16-bit counts, big-endian.
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

TEST(EstimateDensities, ReturnsDensitiesOutsideAndInsideBall) {
  const Volume volume = shape_volume(centred_cube(40, 0.25), ball(Vec3::Zero(), 3));
  const BoneDensities densities = estimate_densities(volume);
  EXPECT_EQ(densities.surroundings, 0);
  EXPECT_EQ(densities.reference, 1000);
}

TEST(EstimateDensities, FindsAirAndDentineInBuiltinTooth) {
  const BoneDensities densities = estimate_densities(Volume(builtin_tooth(), kBuiltinToothIsovalue));
  EXPECT_NEAR(densities.surroundings, 0, 1);
  EXPECT_NEAR(densities.reference, 1500, 1);
}

TEST(EstimateDensities, FindsMediumAndDentineInRealTooth) {
  OSTEOMILL_NEEDS_SHARED("tooth/original/tooth.raw");
  const BoneDensities counts = estimate_densities(real_tooth());
  EXPECT_NEAR(counts.surroundings, 392, 20);
  EXPECT_NEAR(counts.reference, 825, 25);
  const BoneDensities hounsfield = estimate_densities(real_tooth(3.5, -1380));
  EXPECT_NEAR(hounsfield.surroundings, -8, 70);
  EXPECT_NEAR(hounsfield.reference, 1507, 88);
}

TEST(EstimateDensities, BracketsIsovalueInUniformVolumes) {
  for (const Volume& volume : {uniform_volume(0, 500), uniform_volume(1000, 500), uniform_volume(500, 500),
                               uniform_volume(0, 0), uniform_volume(-1000, -1500)}) {
    const BoneDensities densities = estimate_densities(volume);
    EXPECT_LT(densities.surroundings, volume.isovalue());
    EXPECT_GT(densities.reference, volume.isovalue());
  }
}

}  // namespace
}  // namespace osteomill
