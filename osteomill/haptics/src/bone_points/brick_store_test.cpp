#include "bone_points/brick_store.h"

#include <gtest/gtest.h>

#include "tests/shapes.h"

namespace osteomill {
namespace {

TEST(BrickStore, BrickHasASlotOnlyWhileItHasSurfacePoints) {
  Volume volume = testing_support::shape_volume(testing_support::centred_cube(32, 0.13),
                                                testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
  const SurfaceLattice lattice(volume, 0.13);
  BrickStore store(4, 64, 64);
  std::uint32_t slot = BrickStore::kNoSlot;
  EXPECT_EQ(store.build(lattice, {1, 1, 3}, slot), SurfaceLattice::Occupancy::no_bone);
  EXPECT_EQ(slot, BrickStore::kNoSlot);
  EXPECT_EQ(store.build(lattice, {1, 1, 1}, slot), SurfaceLattice::Occupancy::all_bone);
  EXPECT_EQ(slot, BrickStore::kNoSlot);
  EXPECT_EQ(store.build(lattice, {1, 1, 2}, slot), SurfaceLattice::Occupancy::surface);
  ASSERT_NE(slot, BrickStore::kNoSlot);
  EXPECT_TRUE(store.is_used(slot));
  EXPECT_EQ(store.brick(slot), (VoxelIndex{1, 1, 2}));
  EXPECT_FALSE(store.is_stale(lattice, slot));
  for_each(volume.geometry().all_voxels(), [&](const VoxelIndex& v) { volume.lower_density(v, 0); });
  EXPECT_TRUE(store.is_stale(lattice, slot));
  EXPECT_EQ(store.build(lattice, {1, 1, 2}, slot), SurfaceLattice::Occupancy::no_bone);
  EXPECT_EQ(slot, BrickStore::kNoSlot);
  EXPECT_EQ(store.fine().total(), 0u);
}

TEST(BrickStore, EvictsOnlyBricksThatAreNotKept) {
  const Volume volume = testing_support::shape_volume(testing_support::centred_cube(32, 0.13),
                                                      testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
  const SurfaceLattice lattice(volume, 0.13);
  BrickStore store(2, 64, 64);
  std::uint32_t kept = BrickStore::kNoSlot, other = BrickStore::kNoSlot;
  store.build(lattice, {1, 1, 2}, kept);
  store.build(lattice, {2, 1, 2}, other);
  EXPECT_FALSE(store.has_free_space());
  int forgotten = 0;
  store.evict_far_bricks([](const VoxelIndex& brick) { return brick.i == 1; },
                         [&](const VoxelIndex& brick) { forgotten += brick.i; });
  EXPECT_EQ(forgotten, 2);
  EXPECT_TRUE(store.is_used(kept));
  EXPECT_FALSE(store.is_used(other));
}

}  // namespace
}  // namespace osteomill
