#include "osteomill/openigtlink/bone_sender.h"

#include <chrono>
#include <memory>
#include <numbers>
#include <thread>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/milling/burr_mill.h"

#include "tests/shapes.h"
#include "tests/support/igtl_stand_in.h"

namespace osteomill {
namespace {

using namespace std::chrono_literals;
using testing_support::IgtlStandIn;

GridGeometry turned_grid() {
  GridGeometry grid = testing_support::centred_cube(31, 0.5);
  grid.spacing_mm = {0.5, 0.4, 0.3};
  grid.direction = Mat3{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}};
  grid.origin_mm = {3, -4, 5};
  return grid;
}

IgtlStandIn::Image await_messages(const IgtlStandIn& server, int wanted) {
  for (int n = 0; n < 5000 && server.image().messages < wanted; ++n) std::this_thread::sleep_for(1ms);
  return server.image();
}

void expect_same(const IgtlStandIn::Image& image, const Volume& bone) {
  std::size_t n = 0;
  const auto& [ni, nj, nk] = bone.geometry().dims;
  ASSERT_EQ(image.values.size(), bone.geometry().voxel_count());
  for (int k = 0; k < nk; ++k) {
    for (int j = 0; j < nj; ++j) {
      for (int i = 0; i < ni; ++i, ++n) ASSERT_EQ(image.values[n], (bone.grid()[VoxelIndex{i, j, k}])) << n;
    }
  }
}

class BoneSenderTest : public ::testing::Test {
 protected:
  BoneSenderTest()
      : bone_(std::make_shared<Volume>(testing_support::shape_volume(
            turned_grid(), testing_support::ball(turned_grid().world_from_voxel(Vec3(15, 15, 15)), 4)))),
        follower_(bone_) {}
  void mill() {
    BurrMill mill(*bone_, 1.0, {0.0, 1000.0}, {});
    const Vec3 centre_W = bone_->geometry().world_from_voxel(Vec3(15, 15, 28));
    for (int n = 0; n < 200; ++n)
      follower_.bone_changed(*bone_, mill.step(centre_W, {0, 0, -4}, 1e-3).change);
    while (!follower_.catch_up()) follower_.bone_changed(*bone_, {});
  }

  IgtlStandIn server_;
  std::shared_ptr<Volume> bone_;
  BoneFollower follower_;
};

TEST_F(BoneSenderTest, SendsTheWholeBoneFirstAtItsPosition) {
  const BoneSender sender(follower_, server_.address(), 30);
  const IgtlStandIn::Image image = await_messages(server_, 1);
  expect_same(image, *bone_);
  // Position of a voxel, in RAS, from the image's centre, axes and spacing.
  const GridGeometry& grid = bone_->geometry();
  const Vec3 voxel(3, 20, 7);
  Vec3 ras_mm;
  for (int row = 0; row < 3; ++row) {
    ras_mm[row] = image.matrix[row][3];
    for (int axis = 0; axis < 3; ++axis)
      ras_mm[row] += static_cast<double>(image.matrix[row][axis]) *
                     static_cast<double>(image.spacing_mm[static_cast<std::size_t>(axis)]) *
                     (voxel[axis] - 0.5 * (grid.dims[static_cast<std::size_t>(axis)] - 1));
  }
  const Vec3 lps_mm = grid.world_from_voxel(voxel);
  EXPECT_NEAR((ras_mm - Vec3(-lps_mm.x(), -lps_mm.y(), lps_mm.z())).norm(), 0, 1e-5);
}

TEST_F(BoneSenderTest, SendsOnlyChangedPartsAfterMilling) {
  const BoneSender sender(follower_, server_.address(), 30);
  await_messages(server_, 1);
  mill();
  const IgtlStandIn::Image image = await_messages(server_, 2);
  expect_same(image, *bone_);
  EXPECT_LT(image.last_values, image.values.size() / 4);
  // Without a change nothing is sent.
  std::this_thread::sleep_for(700ms);
  EXPECT_EQ(server_.image().messages, image.messages);
}

TEST_F(BoneSenderTest, SendsPendingChangesOnDestruction) {
  {
    const BoneSender sender(follower_, server_.address(), 30);
    await_messages(server_, 1);
    mill();
  }
  expect_same(await_messages(server_, 2), *bone_);
}

TEST_F(BoneSenderTest, SendsToolStateAtMostAtTheRequestedRate) {
  BoneSender sender(follower_, server_.address(), 50);
  TickRecord now;
  now.X_WT = {{1, 2, 3}, quaternion_from_rotation_vector({0, 0.5 * std::numbers::pi, 0})};
  now.wrench.force_N = {0, 3, 4};
  now.removed_mm3 = 12.345;
  const auto end = std::chrono::steady_clock::now() + 500ms;
  while (std::chrono::steady_clock::now() < end) {
    sender.show_tool(now);
    std::this_thread::sleep_for(1ms);
  }
  const IgtlStandIn::Tool tool = server_.tool();
  EXPECT_EQ(tool.name, "OsteomillTool");
  EXPECT_GE(tool.messages, 5);
  EXPECT_LE(tool.messages, 26);
  EXPECT_EQ(tool.readings, "force 5.00 N, torque 0.0 N mm, removed 12.35 mm^3, spindle off");
  // The burr's centre, and the shaft along x of W, in RAS.
  EXPECT_EQ(Vec3(tool.matrix[0][3], tool.matrix[1][3], tool.matrix[2][3]), Vec3(-1, -2, 3));
  EXPECT_NEAR((Vec3(tool.matrix[0][2], tool.matrix[1][2], tool.matrix[2][2]) - Vec3(-1, 0, 0)).norm(), 0,
              1e-6);
}

TEST_F(BoneSenderTest, ReportsDisconnectionWhenTheReceiverCloses) {
  const BoneSender sender(follower_, server_.address(), 30);
  await_messages(server_, 1);
  server_.closes = true;
  for (int n = 0; n < 3000 && sender.is_connected(); ++n) std::this_thread::sleep_for(1ms);
  EXPECT_FALSE(sender.is_connected());
}

TEST_F(BoneSenderTest, ThrowsWithoutAListenerOrWithAnInvalidAddress) {
  EXPECT_THROW(BoneSender(follower_, "127.0.0.1:1", 30), InputError);
  EXPECT_THROW(BoneSender(follower_, "here", 30), InputError);
}

}  // namespace
}  // namespace osteomill
