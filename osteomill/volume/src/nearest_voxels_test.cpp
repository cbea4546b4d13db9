#include "osteomill/volume/nearest_voxels.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

TEST(NearestVoxels, MatchesBruteForceOnAnisotropicGrid) {
  const Vec3 spacing_mm(0.3, 0.45, 1.1);
  const VoxelBox box{{-3, 2, 0}, {12, 20, 8}};
  std::mt19937 random(4);
  for (const int voxels : {1, 2, 40}) {
    VoxelSet set(VoxelBox{{-1, 3, 1}, {9, 19, 7}});
    std::vector<VoxelIndex> all;
    for (int n = 0; n < voxels; ++n) {
      all.push_back({-1 + static_cast<int>(random() % 11), 3 + static_cast<int>(random() % 17),
                     1 + static_cast<int>(random() % 7)});
      set.insert(all.back());
    }
    const NearestVoxels nearest(set, box, spacing_mm);
    ASSERT_TRUE(nearest.found());
    for_each(box, [&](const VoxelIndex& v) {
      double least_mm = std::numeric_limits<double>::infinity();
      for (const VoxelIndex& one : all)
        least_mm =
            std::min(least_mm, Vec3(v.i - one.i, v.j - one.j, v.k - one.k).cwiseProduct(spacing_mm).norm());
      ASSERT_NEAR(nearest.distance_mm(v), least_mm, 1e-6);
      ASSERT_TRUE(set.contains(nearest.nearest_to(v)));
    });
    const NearestVoxels to_faces(set, box, spacing_mm, NearestVoxels::To::faces);
    const auto to_cube_mm = [&](const VoxelIndex& from, const VoxelIndex& one) {
      const Vec3 apart = Vec3(from.i - one.i, from.j - one.j, from.k - one.k).cwiseAbs();
      return (apart.array() - 0.5).cwiseMax(0).matrix().cwiseProduct(spacing_mm).norm();
    };
    for_each(box, [&](const VoxelIndex& v) {
      double least_mm = std::numeric_limits<double>::infinity();
      for (const VoxelIndex& one : all) least_mm = std::min(least_mm, to_cube_mm(v, one));
      ASSERT_NEAR(to_cube_mm(v, to_faces.nearest_to(v)), least_mm, 1e-6);
    });
  }
}

TEST(NearestVoxels, IsInfinitelyFarFromAnEmptySet) {
  const NearestVoxels nearest(VoxelSet{}, VoxelBox{{0, 0, 0}, {2, 2, 2}}, Vec3::Ones());
  EXPECT_FALSE(nearest.found());
  EXPECT_TRUE(std::isinf(nearest.distance_mm({1, 1, 1})));
}

}  // namespace
}  // namespace osteomill
