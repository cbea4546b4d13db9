#include "osteomill/study/entry_pictures.h"

#include <gtest/gtest.h>

#include "osteomill/visual/bone_picture.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::centred_cube;
using testing_support::shape_volume;

// Mills a hole in a block, open to the viewer or behind a ridge, and returns the share seen.
double seen_of_hole(double ridge_mm) {
  const Volume before = shape_volume(centred_cube(60, 0.25), [&](const Vec3& p) {
    const double block = std::max(p.head<2>().cwiseAbs().maxCoeff() - 6.5, p.z());
    const double ridge = std::max({std::abs(p.y()) - 6.5, std::abs(p.x()) - 6.5, p.z() - ridge_mm});
    return std::min(block, p.head<2>().norm() > 2.2 ? ridge : 10.0);
  });
  const Camera camera = camera_above(before, Vec3::Zero(), -Vec3::UnitZ(), Vec3::UnitX());
  Volume milled = before;
  EXPECT_EQ(visible_fraction(before, milled, camera), 1);
  for_each(before.geometry().all_voxels(), [&](const VoxelIndex& v) {
    const Vec3 p = before.geometry().world_from_voxel(v);
    if ((p - Vec3(0, 0, 0.5)).norm() < 2) milled.lower_density(v, 0);
  });
  return visible_fraction(before, milled, camera);
}

TEST(EntryPictures, VisibleFractionIsHighForAnOpenHoleAndLowBehindARidge) {
  EXPECT_GT(seen_of_hole(0), 0.8);
  EXPECT_LT(seen_of_hole(6), 0.4);
}

}  // namespace
}  // namespace osteomill
