#include "density_handover.h"

#include <gtest/gtest.h>

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::shape_volume;

TEST(DensityHandover, SendsAMarkedBrickOnceWithItsLatestDensities) {
  Volume volume = shape_volume(centred_cube(20, 1), ball(Vec3::Zero(), 30));
  DensityHandover handover(volume.geometry(), 4);
  volume.lower_density({9, 3, 17}, 5);
  handover.mark({{{9, 3, 17}, {9, 3, 17}}});
  volume.lower_density({9, 3, 17}, 4);
  handover.mark({{{9, 3, 17}, {9, 3, 17}}});
  EXPECT_EQ(handover.waiting_count(), 1u);
  EXPECT_EQ(handover.front(), nullptr);
  handover.send(volume, 10);
  DensityBlock* brick = handover.front();
  ASSERT_NE(brick, nullptr);
  EXPECT_EQ(brick->first, (VoxelIndex{8, 0, 16}));
  EXPECT_EQ(brick->densities[1 + 8 * (3 + 8 * 1)], 4.0f);
  EXPECT_EQ(brick->densities[0], 1000.0f);
  handover.pop();
  EXPECT_EQ(handover.front(), nullptr);
}

TEST(DensityHandover, KeepsUnsentBricksMarkedAndSendsTheOldestFirst) {
  Volume volume = shape_volume(centred_cube(64, 1), ball(Vec3::Zero(), 100));
  DensityHandover handover(volume.geometry(), 3);
  handover.mark({{{0, 0, 0}, {63, 0, 0}}});
  handover.send(volume, 2);
  EXPECT_EQ(handover.waiting_count(), 6u);
  handover.send(volume, 5);
  EXPECT_EQ(handover.waiting_count(), 5u);  // room for one
  handover.mark({{{0, 0, 0}, {0, 0, 0}}});
  EXPECT_EQ(handover.waiting_count(), 6u);
  for (const int first : {0, 8, 16, 24, 32, 40, 48, 56, 0}) {
    ASSERT_NE(handover.front(), nullptr);
    EXPECT_EQ(handover.front()->first.i, first);
    handover.pop();
    handover.send(volume, 5);
  }
  EXPECT_EQ(handover.waiting_count(), 0u);
  EXPECT_EQ(handover.front(), nullptr);
}

}  // namespace
}  // namespace osteomill
