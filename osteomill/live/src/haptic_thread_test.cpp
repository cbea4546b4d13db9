#include "osteomill/live/haptic_thread.h"

#include <atomic>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/haptics/algorithms.h"

#include "tests/descending_device.h"
#include "tests/no_more_threads.h"
#include "tests/own_memory.h"
#include "tests/shapes.h"
#include "tests/wait.h"

namespace osteomill {
namespace {

using namespace std::chrono_literals;
using testing_support::becomes_true_in_time;

// Moves the burr to 0.3 mm depth in the bone below z = 0 and stores what was sent. Its members belong to the
// haptic thread while the session runs.
class PressedDevice : public testing_support::DescendingDevice {
 public:
  PressedDevice() : DescendingDevice(1.2) {}

  Wrench sent;
  double max_force_N = 0;
  double time_passed_s = 0;
  int throw_at_tick = -1;
  int ticks = 0;
  std::atomic<bool> gives_pose{true};

  Pose read_pose() override {
    if (ticks++ == throw_at_tick) throw std::runtime_error("the cable came off");
    if (!gives_pose) return {Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), Quat::Identity()};
    return DescendingDevice::read_pose();
  }
  void write_wrench(const Wrench& wrench) override {
    sent = wrench;
    max_force_N = std::max(max_force_N, wrench.force_N.norm());
  }
  void tick_done(const Pose&, double dt_s) noexcept override { time_passed_s += dt_s; }
};

Volume half_space() {
  return testing_support::shape_volume(testing_support::centred_cube(40, 0.25),
                                       testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
}

std::unique_ptr<MillingSession> session_on(std::shared_ptr<Volume> bone, std::string_view algorithm) {
  return std::make_unique<MillingSession>(std::move(bone), BoneDensities{0, 1000},
                                          MillingSetup{.algorithm = algorithm_named(algorithm)});
}

class HapticThreadTest : public ::testing::Test {
 protected:
  bool pushes() {
    return becomes_true_in_time([&] { return live_.state().record.wrench.force_N.z() > 0; });
  }

  std::shared_ptr<Volume> bone_ = std::make_shared<Volume>(half_space());
  PressedDevice device_;
  HapticThread live_{session_on(bone_, "point-shell"), device_};
};

TEST_F(HapticThreadTest, TicksInRealTimeAndStopsWithZeroWrench) {
  live_.start();
  EXPECT_TRUE(pushes());
  EXPECT_TRUE(becomes_true_in_time([&] { return live_.state().record.contacts > 0; }));
  EXPECT_TRUE(becomes_true_in_time([&] { return live_.timing().ticks > 200; }));
  EXPECT_TRUE(live_.is_running());
  live_.stop();
  EXPECT_FALSE(live_.is_running());
  EXPECT_GT(device_.max_force_N, 0);
  EXPECT_EQ(device_.sent.force_N, Vec3::Zero());
  EXPECT_EQ(device_.sent.torque_Nmm, Vec3::Zero());
  const TimingSummary timing = live_.timing();
  // A loaded machine misses ticks and counts them. The time simulated for the device is at most that of ticks
  // and missed ticks together; less only if more than 20 were missed at once.
  const double ticked_s = 1e-3 * static_cast<double>(timing.ticks);
  EXPECT_GE(device_.time_passed_s, ticked_s - 1e-9);
  EXPECT_LE(device_.time_passed_s, ticked_s + 1e-3 * static_cast<double>(timing.missed_ticks) + 1e-9);
}

// On a clock set by the test, so that it takes no time and is exact to the nanosecond.
TEST(HapticThreadOnTestClock, SkipsAndCountsTicksMissedByASlowTick) {
  std::atomic<Nanoseconds> now_ns{0};
  const TickClock clock{[&] { return now_ns.load(); },
                        [&](Nanoseconds deadline_ns) {
                          if (now_ns < deadline_ns) now_ns = deadline_ns;
                          return now_ns.load();
                        }};
  class SlowDevice final : public PressedDevice {
   public:
    explicit SlowDevice(std::atomic<Nanoseconds>& now) : now_ns(now) {}
    Pose read_pose() override {
      if (ticks == 10) now_ns += 3'400'000;
      return PressedDevice::read_pose();
    }
    std::atomic<Nanoseconds>& now_ns;
  } device(now_ns);
  device.throw_at_tick = 30;
  HapticThread live(session_on(std::make_shared<Volume>(half_space()), "line-proxy"), device, clock);
  live.start();
  ASSERT_TRUE(becomes_true_in_time([&] { return !live.is_running(); }));
  live.stop();
  EXPECT_EQ(live.timing().ticks, 30u);
  EXPECT_EQ(live.timing().missed_ticks, 2u);
  EXPECT_NEAR(device.time_passed_s, 0.032, 1e-9);
}

TEST_F(HapticThreadTest, VolumeCopiesStillSharePagesAfterARun) {
  GridGeometry geometry;
  geometry.dims = {256, 256, 256};
  const Volume scan(DensityGrid(geometry, std::vector<float>(256 * 256 * 256, 1000.0f)), 500);
  const Volume copy = scan;
  live_.start();
  live_.stop();
  for (const Volume* bone : {&scan, &copy}) {
    const double own_MiB = testing_support::copied_MiB(bone->grid().densities().data());
    EXPECT_GE(own_MiB, 0);
    EXPECT_LT(own_MiB, 1) << "the whole is 64 MiB";
  }
}

TEST_F(HapticThreadTest, DeliversTheRecordOfEveryTickInOrder) {
  live_.start();
  std::this_thread::sleep_for(100ms);
  live_.stop();
  double last_s = -1;
  std::uint64_t count = 0;
  while (const auto record = live_.next_record()) {
    EXPECT_GT(record->time_s, last_s);
    last_s = record->time_s;
    ++count;
  }
  EXPECT_EQ(count, live_.timing().ticks);
}

TEST_F(HapticThreadTest, ReplacementSessionCarriesOutAPendingPlacement) {
  live_.start();
  EXPECT_TRUE(pushes());
  device_.gives_pose = false;
  live_.place({{0, 0, 9}, Quat::Identity()});
  EXPECT_TRUE(becomes_true_in_time([&] { return live_.state().record.wrench.force_N.isZero(0); }));
  std::this_thread::sleep_for(20ms);
  EXPECT_TRUE(live_.is_placing());
  live_.replace(session_on(bone_, "point-shell"));
  std::this_thread::sleep_for(20ms);
  EXPECT_TRUE(live_.is_placing());
  device_.gives_pose = true;
  EXPECT_TRUE(becomes_true_in_time([&] { return !live_.is_placing(); }));
  EXPECT_TRUE(becomes_true_in_time([&] { return live_.state().record.X_WT.position_mm.z() == 9; }));
  live_.stop();
}

TEST_F(HapticThreadTest, SpindleMillsBoneUnlessItIsFrozen) {
  live_.start();
  live_.set_spindle(true);
  EXPECT_TRUE(becomes_true_in_time([&] { return live_.state().record.removed_mm3 > 0; }));
  live_.freeze_bone(true);
  const double removed_mm3 = live_.state().record.removed_mm3;
  const CopyOnWriteFloats frozen = bone_->grid().densities();
  EXPECT_NE(frozen, half_space().grid().densities());
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(bone_->grid().densities(), frozen);
  EXPECT_TRUE(live_.state().spindle_on);
  live_.freeze_bone(false);
  EXPECT_TRUE(becomes_true_in_time([&] { return live_.state().record.removed_mm3 > removed_mm3; }));
  live_.stop();
  EXPECT_NE(bone_->grid().densities(), frozen);
}

TEST_F(HapticThreadTest, PauseSendsZeroWrenchAndHoldsTheToolAboveTheDevice) {
  live_.start();
  EXPECT_TRUE(pushes());
  live_.set_spindle(true);
  live_.set_paused(true);
  EXPECT_TRUE(becomes_true_in_time([&] { return is_zero(live_.state().record.wrench); }));
  const LiveState state = live_.state();
  EXPECT_TRUE(state.record.paused);
  EXPECT_FALSE(state.spindle_on);
  EXPECT_EQ(state.record.wrench.force_N, Vec3::Zero());
  EXPECT_GT(state.record.X_WT.position_mm.z(), state.record.X_WD.position_mm.z());
}

// The hand may have moved into the bone while no ticks ran.
TEST_F(HapticThreadTest, RestartInBoneGivesNoForceUntilLifted) {
  live_.start();
  EXPECT_TRUE(pushes());
  live_.stop();
  device_.max_force_N = 0;
  const std::uint64_t ticks = live_.timing().ticks;
  live_.set_spindle(true);
  const double removed_mm3 = live_.state().record.removed_mm3;
  live_.start();
  EXPECT_TRUE(becomes_true_in_time([&] { return live_.timing().ticks > ticks + 100; }));
  live_.stop();
  EXPECT_EQ(live_.state().record.fault, WrenchFault::held_back);
  EXPECT_EQ(live_.state().record.removed_mm3, removed_mm3);
  EXPECT_EQ(device_.max_force_N, 0);
  device_.lift();
  live_.start();
  EXPECT_TRUE(pushes());
}

TEST_F(HapticThreadTest, ReplacementSessionTakesOverWhileRunning) {
  live_.start();
  EXPECT_TRUE(pushes());
  live_.freeze_bone(true);
  const double removed_mm3 = 7;
  auto next = session_on(bone_, "surface-points");
  const int points = next->algorithm().sample_point_count();
  next->count_removed_from(removed_mm3);
  live_.replace(std::move(next));
  live_.freeze_bone(false);
  EXPECT_TRUE(becomes_true_in_time([&] {
    const TickRecord& record = live_.state().record;
    return record.session == 1 && record.wrench.force_N.z() > 0;
  }));
  live_.stop();
  EXPECT_EQ(live_.session().algorithm().sample_point_count(), points);
  EXPECT_EQ(live_.state().record.removed_mm3, removed_mm3);
}

TEST_F(HapticThreadTest, ListenerReceivesTicksAndChangesUntilRemoved) {
  struct Heard {
    int ticks = 0;
    VoxelBox changed;
  } heard;
  live_.set_spindle(true);
  live_.set_listener([&heard](const TickRecord&, const Volume&, const VolumeChange& change) {
    ++heard.ticks;
    if (change.voxels.empty()) return;
    heard.changed.include(change.voxels.first);
    heard.changed.include(change.voxels.last);
  });
  live_.start();
  EXPECT_TRUE(becomes_true_in_time([&] { return live_.state().record.removed_mm3 > 0; }));
  live_.set_spindle(false);
  live_.set_listener({});
  const int ticks = heard.ticks;
  std::this_thread::sleep_for(20ms);
  live_.stop();
  EXPECT_GT(ticks, 5);
  EXPECT_EQ(heard.ticks, ticks);
  ASSERT_FALSE(heard.changed.empty());
  const Volume before = half_space();
  int outside = 0;
  for (std::size_t n = 0; n < before.geometry().voxel_count(); ++n) {
    const int place = static_cast<int>(n);
    const VoxelIndex voxel{place % 40, place / 40 % 40, place / 1600};
    if (heard.changed.contains(voxel)) continue;
    ++outside;
    ASSERT_EQ(bone_->grid()[voxel], before.grid()[voxel]);
  }
  EXPECT_GT(outside, 50000);
}

TEST_F(HapticThreadTest, ThrowingDeviceStopsItWithZeroForceAndAReason) {
  device_.throw_at_tick = 500;
  live_.start();
  EXPECT_TRUE(becomes_true_in_time([&] { return !live_.is_running(); }));
  live_.set_spindle(true);
  EXPECT_EQ(device_.sent.force_N, Vec3::Zero());
  EXPECT_GT(device_.max_force_N, 0);
  ASSERT_NE(live_.failure(), nullptr);
  EXPECT_EQ(reason_of(live_.failure()), "the cable came off");
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(HapticThreadTest, CanBeStartedAfterAFailedStart) {
  {
    const testing_support::NoMoreThreads none;
    EXPECT_THROW(live_.start(), std::system_error);
  }
  EXPECT_FALSE(live_.is_running());
  live_.set_spindle(true);
  live_.start();
  EXPECT_TRUE(becomes_true_in_time([&] { return live_.timing().ticks > 10; }));
}
#endif

}  // namespace
}  // namespace osteomill
