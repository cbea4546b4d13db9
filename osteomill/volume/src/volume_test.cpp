#include "osteomill/volume/volume.h"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "osteomill/volume/editable_volume.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

Volume half_of_bone() {
  return shape_volume(centred_cube(20, 0.25), plane(Vec3::Zero(), Vec3::UnitZ()));
}

TEST(Volume, LowerRowNeverRaisesDensities) {
  Volume bone = half_of_bone();
  const int columns[] = {2, 3, 4};
  const float lower[] = {-100, -200, -300};
  bone.lower_row(5, 5, columns, lower, 3);
  const Volume milled = bone;
  const float higher[] = {900, -200, std::numeric_limits<float>::quiet_NaN()};
  bone.lower_row(5, 5, columns, higher, 3);
  EXPECT_EQ(bone.grid().densities(), milled.grid().densities());
  EXPECT_EQ(bone.change_hash(), milled.change_hash());
}

TEST(EditableVolume, SwappingABlockTwiceRestoresTheBone) {
  const Volume scan = half_of_bone();
  Volume bone = scan;
  // The last block extends beyond the grid.
  for (const VoxelIndex& first : {VoxelIndex{0, 8, 8}, VoxelIndex{16, 16, 16}}) {
    DensityBlock filled(bone.grid(), first);
    filled.densities.fill(2000);
    const VoxelBox changed = EditableVolume(bone).swap(filled);
    EXPECT_EQ(changed, filled.voxels_in(bone.geometry()));
    EXPECT_EQ(bone.grid()[changed.last], 2000);
    EXPECT_EQ(bone.ranges().at(first.i / 8, first.j / 8, first.k / 8).max, 2000);
    EditableVolume(bone).swap(filled);
    EXPECT_EQ(bone.grid().densities(), scan.grid().densities());
  }
}

TEST(EditableVolume, RefusesNanIsovalueAndKeepsTheOldOne) {
  Volume bone = half_of_bone();
  const double before = bone.isovalue();
  EXPECT_THROW(EditableVolume(bone).set_isovalue(std::numeric_limits<double>::quiet_NaN()),
               std::invalid_argument);
  EXPECT_EQ(bone.isovalue(), before);
  EditableVolume(bone).set_isovalue(before + 1);
  EXPECT_EQ(bone.isovalue(), before + 1);
}

}  // namespace
}  // namespace osteomill
