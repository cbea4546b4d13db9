#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/volume/isovalue.h"

namespace osteomill {
namespace {

// Uniform densities 0 to 999 and one outlier.
TEST(DensityHistogram, IsFlatForUniformDensitiesAndIgnoresOutlier) {
  GridGeometry geometry;
  geometry.dims = {100, 100, 100};
  std::vector<float> densities;
  for (int n = 0; n < 1000000; ++n) densities.push_back(static_cast<float>(n % 1000));
  densities.front() = 1e6f;
  const DensityHistogram histogram = histogram_of(DensityGrid(geometry, densities));
  EXPECT_NEAR(histogram.min, 0, 2);
  EXPECT_NEAR(histogram.max, 999, 2);
  // One seventh of a million samples in 128 bins.
  for (const float count : histogram.log_counts) EXPECT_NEAR(count, std::log1p(1e6 / 7 / 128), 0.15);
}

TEST(DensityHistogram, HasNonEmptyRangeForSingleDensity) {
  GridGeometry geometry;
  geometry.dims = {10, 10, 10};
  const DensityHistogram histogram = histogram_of(DensityGrid(geometry, std::vector<float>(1000, 40.0f)));
  EXPECT_EQ(histogram.min, 40);
  EXPECT_GT(histogram.max, histogram.min);
  EXPECT_GT(histogram.log_counts.front(), 0);
}

}  // namespace
}  // namespace osteomill
