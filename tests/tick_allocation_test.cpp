#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/live/bone_follower.h"
#include "osteomill/live/haptic_thread.h"
#include "osteomill/session/milling_session.h"
#include "osteomill/session/trajectory.h"
#include "osteomill/volume/bone_densities.h"

#include "tests/count_allocations.h"
#include "tests/descending_device.h"
#include "tests/poses.h"
#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::allocations_of_this_thread;

TEST(TickAllocation, CounterSeesAllocations) {
  const long before = allocations_of_this_thread();
  auto something = std::make_unique<std::vector<int>>(100);
  EXPECT_GE(allocations_of_this_thread() - before, 2) << something->size();
}

struct Case {
  std::string_view algorithm;
};

class TickAllocation : public ::testing::TestWithParam<Case> {};

// Returns labels with a no-go structure in the middle of bone of five other labels.
std::shared_ptr<const LabelMap> labels_of(const GridGeometry& grid) {
  std::vector<LabelMap::LabelIndex> places;
  for (int k = 0; k < grid.dims[2]; ++k) {
    for (int j = 0; j < grid.dims[1]; ++j) {
      for (int i = 0; i < grid.dims[0]; ++i)
        places.push_back(static_cast<LabelMap::LabelIndex>(std::abs(i - 32) < 3 ? 6 : 1 + i % 5));
    }
  }
  std::vector<Label> labels(6);
  labels.back().no_go = true;
  return std::make_shared<const LabelMap>(labels, grid, grid, places);
}

// Returns the distances from a nerve, made of voxels, and a ball.
NoGoDistances structures_in(const GridGeometry& grid) {
  VoxelSet nerve(VoxelBox{{30, 0, 20}, {31, 63, 21}});
  for_each(nerve.box(), [&](const VoxelIndex& v) { nerve.insert(v); });
  return {{StructureDistance(nerve, grid)}, {StructureDistance(SphereShape{{0, 0, -4}, 1})}};
}

// Descends, mills and leans the shaft on the edge; also jumps across the bone, sends a non-finite pose, and
// resets.
TEST_P(TickAllocation, NoTickAllocates) {
  constexpr double kBallRadius_mm = 6;
  Volume volume = testing_support::shape_volume(testing_support::centred_cube(64, 0.25),
                                                testing_support::ball(Vec3::Zero(), kBallRadius_mm));
  volume.set_labels(labels_of(volume.geometry()));
  volume.set_no_go(std::make_shared<NoGoDistances>(structures_in(volume.geometry())));
  const MillingTool tool;
  const BoneDensities densities = estimate_densities(volume);
  MillingSession session(std::make_shared<Volume>(std::move(volume)), densities,
                         {.algorithm = algorithm_named(GetParam().algorithm), .haptics = {}});
  PosedDevice device;
  constexpr int kTicks = 3000;
  int touching = 0;
  double removed_mm3 = 0, labelled_mm3 = 0;
  double nearest_mm = std::numeric_limits<double>::infinity();
  bool touched_no_go = false;
  const long before = allocations_of_this_thread();
  for (int n = 0; n < kTicks; ++n) {
    Pose pose = testing_support::down_and_lean(kBallRadius_mm, tool.burr_radius_mm, 2.0,
                                               static_cast<double>(n) / kTicks);
    if (n == 2500) pose.position_mm.x() = std::numeric_limits<double>::quiet_NaN();
    if (n == 2600) pose.position_mm = {0, 0, -20};
    device.put(pose);
    // The last ticks only report labels that did not fit into earlier records.
    const TickRecord record = session.tick(device, {.time_s = n * 1e-3, .spindle_on = n < kTicks - 3});
    touching += record.contacts > 0 ? 1 : 0;
    removed_mm3 = record.removed_mm3;
    nearest_mm = std::fmin(nearest_mm, record.no_go_distance_mm);
    for (const LabelCut& cut : record.label_cuts) {
      labelled_mm3 += cut.removed_mm3;
      touched_no_go = touched_no_go || cut.label == 6;
    }
    if (n == 2500) {
      EXPECT_EQ(record.fault, WrenchFault::pose_not_finite);
      EXPECT_EQ(device.sent().force_N, Vec3::Zero());
    }
  }
  const long allocated = allocations_of_this_thread() - before;
  EXPECT_EQ(allocated, 0);
  EXPECT_GT(touching, kTicks / 3);
  EXPECT_GT(removed_mm3, 0.1);
  EXPECT_NEAR(labelled_mm3, removed_mm3, 1e-9);
  EXPECT_TRUE(touched_no_go);
  EXPECT_LT(nearest_mm, 6);
}

INSTANTIATE_TEST_SUITE_P(AllAlgorithms, TickAllocation,
                         ::testing::Values(Case{"line-proxy"}, Case{"surface-points"}, Case{"point-shell"},
                                           Case{"barrier-shell"}),
                         [](const auto& test) {
                           std::string name(test.param.algorithm);
                           name[name.find('-')] = '_';
                           return name;
                         });

TEST(TickAllocation, GuardHoldingTheBurrDoesNotAllocate) {
  Volume volume = testing_support::shape_volume(testing_support::centred_cube(64, 0.25),
                                                testing_support::ball(Vec3::Zero(), 3));
  VoxelSet nerve(VoxelBox{{31, 0, 50}, {32, 63, 51}});
  for_each(nerve.box(), [&](const VoxelIndex& v) { nerve.insert(v); });
  volume.set_no_go(
      std::make_shared<NoGoDistances>(NoGoDistances{{StructureDistance(nerve, volume.geometry()), 0.5}}));
  const BoneDensities densities = estimate_densities(volume);
  MillingSession session(std::make_shared<Volume>(std::move(volume)), densities, {});
  PosedDevice device;
  double nearest_mm = 10, strongest_N = 0;
  const long before = allocations_of_this_thread();
  for (int n = 0; n < 1000; ++n) {
    device.put({{0.0002 * n, 0, 9 - 0.004 * n}, Quat::Identity()});
    const TickRecord record = session.tick(device, {.time_s = n * 1e-3, .spindle_on = true});
    nearest_mm = std::fmin(nearest_mm, record.no_go_distance_mm);
    strongest_N = std::max(strongest_N, record.wrench.force_N.norm());
  }
  EXPECT_EQ(allocations_of_this_thread() - before, 0);
  EXPECT_GT(nearest_mm, 0.45);
  EXPECT_LT(nearest_mm, 0.6);
  EXPECT_GT(strongest_N, 2);
}

// The whole loop of the haptic thread, with the queue to the follower, vibration, and incoming commands.
TEST(TickAllocation, HapticThreadTickDoesNotAllocate) {
  constexpr double kBallRadius_mm = 6;
  const auto bone = std::make_shared<Volume>(testing_support::shape_volume(
      testing_support::centred_cube(64, 0.25), testing_support::ball(Vec3::Zero(), kBallRadius_mm)));
  const MillingTool tool;
  auto session = std::make_unique<MillingSession>(
      bone, estimate_densities(*bone),
      MillingSetup{.algorithm = algorithm_named("point-shell"), .vibration = {.on = true}});
  testing_support::DescendingDevice device(kBallRadius_mm + tool.burr_radius_mm - 0.3);
  device.X_WD.position_mm.z() = kBallRadius_mm + tool.burr_radius_mm + 1;
  BoneFollower follower(bone);
  HapticThread live(std::move(session), device);
  std::atomic<int> ticks{0};
  std::atomic<long> allocations{-1};
  long before = 0;
  live.set_spindle(true);
  live.set_listener([&](const TickRecord&, const Volume& volume, const VolumeChange& change) {
    follower.bone_changed(volume, change);
    const int tick = ticks.fetch_add(1);
    if (tick == 5) before = allocations_of_this_thread();
    if (tick == 300) allocations = allocations_of_this_thread() - before;
  });
  live.start();
  for (int n = 0; n < 2000 && ticks <= 300; ++n) {
    live.set_spindle(n % 3 != 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  live.stop();
  EXPECT_EQ(allocations, 0);
  EXPECT_GT(live.state().record.removed_mm3, 0);
}

}  // namespace
}  // namespace osteomill
