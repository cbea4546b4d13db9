#include <random>

#include <gtest/gtest.h>

#include "osteomill/volume/density_grid.h"
#include "osteomill/volume/editable_volume.h"
#include "osteomill/volume/label_map.h"
#include "osteomill/volume/volume.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::shape_volume;

Volume small_ball() {
  return shape_volume(centred_cube(21, 0.5), ball(Vec3::Zero(), 4));
}

std::uint64_t difference_of_all(const Volume& bone, const Volume& scan) {
  std::uint64_t sum = 0;
  for_each(bone.geometry().all_voxels(), [&](const VoxelIndex& v) {
    const std::size_t n = bone.grid().linear_index(v);
    sum += density_hash(n, bone.grid()[v]) - density_hash(n, scan.grid()[v]);
  });
  return sum;
}

TEST(DensityHash, ChangeHashDependsOnlyOnResultOfEdits) {
  const Volume scan = small_ball();
  Volume bone = scan;
  EXPECT_EQ(bone.change_hash(), 0u);
  std::mt19937 random(1);
  for (int n = 0; n < 500; ++n) {
    const VoxelIndex v{static_cast<int>(random() % 21), static_cast<int>(random() % 21),
                       static_cast<int>(random() % 21)};
    bone.lower_density(v, 0.5F * bone.grid()[v]);
  }
  const int columns[] = {9, 10, 12};
  const float densities[] = {1, 2, 3};
  bone.lower_row(10, 10, columns, densities, 3);
  const std::uint64_t milled = bone.change_hash();
  EXPECT_NE(milled, 0u);
  EXPECT_EQ(milled, difference_of_all(bone, scan));
  // The last brick extends beyond the grid.
  for (const VoxelIndex& first : {VoxelIndex{8, 8, 8}, VoxelIndex{16, 16, 16}}) {
    DensityBlock untouched(scan.grid(), first);
    EditableVolume(bone).swap(untouched);
    EXPECT_EQ(bone.change_hash(), difference_of_all(bone, scan));
    EditableVolume(bone).swap(untouched);
  }
  EXPECT_EQ(bone.change_hash(), milled);
  const Volume copy = bone;
  EXPECT_EQ(copy.change_hash(), milled);
}

TEST(DensityHash, DiffersByVoxelDensityAndSignOfZero) {
  EXPECT_NE(density_hash(1, 2), density_hash(2, 2));
  EXPECT_NE(density_hash(1, 2), density_hash(1, 3));
  EXPECT_NE(density_hash(0, 0.0F), density_hash(0, -0.0F));
}

TEST(DensityHash, FingerprintsChangeWithScanAndLabelMapContent) {
  Volume scan = small_ball();
  const std::uint64_t as_read = fingerprint_of(scan.grid());
  EXPECT_EQ(as_read, fingerprint_of(small_ball().grid()));
  scan.lower_density({10, 10, 10}, 0);
  EXPECT_NE(as_read, fingerprint_of(scan.grid()));

  const GridGeometry& grid = scan.geometry();
  const auto map_of = [&](int value, LabelMap::LabelIndex elsewhere = 0) {
    std::vector<LabelMap::LabelIndex> places(grid.voxel_count(), elsewhere);
    places[500] = 1;
    return LabelMap(std::vector<Label>{{value, "nerve"}}, grid, grid, places);
  };
  EXPECT_EQ(map_of(3).fingerprint(), map_of(3).fingerprint());
  EXPECT_NE(map_of(3).fingerprint(), map_of(4).fingerprint());
  EXPECT_NE(map_of(3).fingerprint(), map_of(3, 1).fingerprint());
}

}  // namespace
}  // namespace osteomill
