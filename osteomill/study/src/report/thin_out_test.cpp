#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "osteomill/study/figure.h"

namespace osteomill {
namespace {

bool contains(const std::vector<std::size_t>& kept, std::size_t index) {
  return std::find(kept.begin(), kept.end(), index) != kept.end();
}

TEST(ThinOutCurve, KeepsEverySpikeInOrder) {
  std::vector<double> values(20000);
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = std::sin(0.01 * static_cast<double>(n));
  values[12345] = 50;
  values[12346] = -50;
  values[0] = 9;
  values[19999] = -9;
  const auto kept = thin_out_curve(values, 500);
  EXPECT_LE(kept.size(), 1000u);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  EXPECT_EQ(std::adjacent_find(kept.begin(), kept.end()), kept.end());
  for (const std::size_t spike : {0u, 12345u, 12346u, 19999u}) EXPECT_TRUE(contains(kept, spike)) << spike;
}

TEST(ThinOutCurve, FewSamplesAreAllKept) {
  EXPECT_EQ(thin_out_curve(std::vector<double>{3, 1, 2}, 2), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_TRUE(thin_out_curve({}, 10).empty());
}

TEST(ThinOutCloud, KeepsTheFarthestDirection) {
  std::vector<Vec3> directions(3000, Vec3::UnitZ());
  directions[1777] = Vec3::UnitX();
  const auto kept = thin_out_cloud(directions, Vec3::UnitZ(), 100);
  EXPECT_LE(kept.size(), 200u);
  EXPECT_TRUE(contains(kept, 1777));
}

}  // namespace
}  // namespace osteomill
