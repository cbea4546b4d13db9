#include <memory>

#include <gtest/gtest.h>

#include "osteomill/live/bone_follower.h"
#include "osteomill/milling/burr_mill.h"

#include "tests/count_allocations.h"
#include "tests/shapes.h"

namespace osteomill {
namespace {

// Includes the case that the drawing thread does not read and the queue overflows.
TEST(TickAllocation, HandoverToFollowerDoesNotAllocate) {
  const auto bone = std::make_shared<Volume>(testing_support::shape_volume(
      testing_support::centred_cube(96, 0.25), testing_support::ball(Vec3::Zero(), 10)));
  BoneFollower follower(bone);
  Volume& volume = *bone;
  BurrMill mill(volume, 1.5, {0, 1000}, {});
  const long before = testing_support::allocations_of_this_thread();
  for (int n = 0; n < 1000; ++n) {
    follower.bone_changed(volume, mill.step({0.01 * n, 0, 11 - 0.002 * n}, {0, 0, -4.0}, 1e-3).change);
  }
  follower.bone_changed(volume, {volume.geometry().all_voxels()});
  for (int n = 0; n < 1000; ++n) follower.bone_changed(volume, {});
  EXPECT_EQ(testing_support::allocations_of_this_thread() - before, 0);
}

}  // namespace
}  // namespace osteomill
