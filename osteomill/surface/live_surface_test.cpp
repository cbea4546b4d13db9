#include "osteomill/surface/live_surface.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <random>
#include <thread>

#include "tests/shapes.h"
#include <gtest/gtest.h>

#include "osteomill/milling/burr_mill.h"
#include "osteomill/surface/mesh_checks.h"
#include "osteomill/surface/surface_mesh.h"

namespace osteomill {
namespace {

using namespace std::chrono_literals;
using testing_support::ball;
using testing_support::centred_cube;
using testing_support::shape_volume;

Volume ball_of_bone() {
  return shape_volume(centred_cube(51, 0.25), ball(Vec3::Zero(), 5.0));
}

// A burr going round on the ball, pressed in.
class Miller {
 public:
  explicit Miller(Volume& volume) : volume_(volume), mill_(volume.geometry(), 1.5, {0.0, 1000.0}, {}) {}
  VolumeChange tick() {
    angle_ += 0.002;
    const Vec3 centre = (6.3 - 0.2 * angle_) * Vec3(std::cos(angle_), std::sin(angle_), 0.2).normalized();
    return mill_.step(volume_, centre, 4.0, 1e-3).change;
  }

 private:
  Volume& volume_;
  BurrMill mill_;
  double angle_ = 0;
};

// Keeps what changed, as a window would.
struct Collected {
  explicit Collected(const SurfaceBricks& layout) : mesh{layout, {}} { mesh.bricks.resize(layout.count()); }
  void take(std::vector<ChangedBrick> changed) {
    for (ChangedBrick& brick : changed) mesh.bricks[brick.brick] = std::move(brick.mesh);
  }
  SurfaceMesh mesh;
};

bool same_surface(const SurfaceMesh& mesh, const Volume& volume, double isovalue) {
  return mesh.bricks == mesh_surface({volume.grid(), volume.bricks(), isovalue}).bricks;
}

// Ticks without milling until the surface is that of the volume, for at most 20 s.
bool settles(LiveSurface& live, Collected& collected, const Volume& volume, double isovalue) {
  for (int n = 0; n < 2000; ++n) {
    for (int tick = 0; tick < 10; ++tick) live.volume_changed(volume, {});
    collected.take(live.take_changed_bricks());
    if (n % 10 == 9 && same_surface(collected.mesh, volume, isovalue)) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

TEST(DensityHandover, SendsWhatIsMarkedOnceAndAsItIsThen) {
  Volume volume = shape_volume(centred_cube(20, 1), ball(Vec3::Zero(), 30));
  DensityHandover handover(volume.geometry(), 4);
  volume.lower_density({9, 3, 17}, 5);
  handover.mark({{{9, 3, 17}, {9, 3, 17}}});
  volume.lower_density({9, 3, 17}, 4);
  handover.mark({{{9, 3, 17}, {9, 3, 17}}});
  EXPECT_EQ(handover.waiting(), 1u);
  EXPECT_EQ(handover.front(), nullptr);
  handover.send(volume, 10);
  const DensityHandover::Brick* brick = handover.front();
  ASSERT_NE(brick, nullptr);
  EXPECT_EQ(brick->first, (VoxelIndex{8, 0, 16}));
  EXPECT_EQ(brick->densities[1 + 8 * (3 + 8 * 1)], 4.0f);
  EXPECT_EQ(brick->densities[0], 1000.0f);
  handover.pop();
  EXPECT_EQ(handover.front(), nullptr);
}

TEST(DensityHandover, KeepsMarkedWhatFindsNoRoomAndSendsTheLongestMarkedFirst) {
  Volume volume = shape_volume(centred_cube(64, 1), ball(Vec3::Zero(), 100));
  DensityHandover handover(volume.geometry(), 3);
  handover.mark({{{0, 0, 0}, {63, 0, 0}}});
  handover.send(volume, 2);
  EXPECT_EQ(handover.waiting(), 6u);
  handover.send(volume, 5);
  EXPECT_EQ(handover.waiting(), 5u);  // room for one
  handover.mark({{{0, 0, 0}, {0, 0, 0}}});
  EXPECT_EQ(handover.waiting(), 6u);
  for (const int first : {0, 8, 16, 24, 32, 40, 48, 56, 0}) {
    ASSERT_NE(handover.front(), nullptr);
    EXPECT_EQ(handover.front()->first.i, first);
    handover.pop();
    handover.send(volume, 5);
  }
  EXPECT_EQ(handover.waiting(), 0u);
  EXPECT_EQ(handover.front(), nullptr);
}

TEST(SurfaceCopy, KeptUpWhileMillingIsTheSurfaceMadeFromScratch) {
  Volume volume = ball_of_bone();
  Miller miller(volume);
  DensityHandover handover(volume.geometry(), 16);
  SurfaceCopy copy(volume);
  Collected collected(copy.layout());
  std::size_t meshed_last = 0;
  for (int tick = 0; tick < 1200; ++tick) {
    handover.mark(miller.tick());
    handover.send(volume, 4);
    while (const auto* brick = handover.front()) {
      copy.put(*brick);
      handover.pop();
    }
    if (tick % 20 == 0) {
      std::vector<ChangedBrick> changed = copy.remesh();
      meshed_last = changed.size();
      collected.take(std::move(changed));
    }
  }
  EXPECT_GT(meshed_last, 0u);
  EXPECT_LT(meshed_last, 20u);  // of 64
  while (handover.waiting() > 0) {
    handover.send(volume, 4);
    while (const auto* brick = handover.front()) {
      copy.put(*brick);
      handover.pop();
    }
  }
  collected.take(copy.remesh());
  EXPECT_TRUE(same_surface(collected.mesh, volume, 500));
  EXPECT_TRUE(copy.remesh().empty());
}

TEST(SurfaceCopy, SaysWhichBricksLostTheirTriangles) {
  Volume volume = shape_volume(centred_cube(40, 0.25), ball({-4, -4, -4}, 0.6));
  SurfaceCopy copy(volume);
  EXPECT_EQ(copy.remesh().size(), 1u);
  copy.set_isovalue(5000);
  const std::vector<ChangedBrick> changed = copy.remesh();
  ASSERT_EQ(changed.size(), 1u);
  EXPECT_TRUE(changed[0].mesh.empty());
  EXPECT_TRUE(copy.remesh().empty());
}

// Ticks at full speed on one thread, drawing on another, the surface on its own; also with the thread
// sanitizer.
TEST(LiveSurface, KeepsUpWithMillingAtFullSpeed) {
  Volume volume = ball_of_bone();
  LiveSurface live(volume);
  Collected collected(live.layout());
  std::atomic<bool> done{false};
  std::thread haptic([&] {
    Miller miller(volume);
    for (int tick = 0; tick < 2000; ++tick) live.volume_changed(volume, miller.tick());
    done = true;
  });
  while (!done) {
    collected.take(live.take_changed_bricks());
    std::this_thread::sleep_for(1ms);
  }
  haptic.join();
  EXPECT_TRUE(settles(live, collected, volume, 500));
}

TEST(LiveSurface, FollowsTheIsovalueWhileMilling) {
  Volume volume = ball_of_bone();
  LiveSurface live(volume);
  Collected collected(live.layout());
  Miller miller(volume);
  for (int tick = 0; tick < 600; ++tick) {
    live.volume_changed(volume, miller.tick());
    if (tick % 40 == 0) live.set_isovalue(300 + tick);
    if (tick % 10 == 0) collected.take(live.take_changed_bricks());
  }
  EXPECT_TRUE(settles(live, collected, volume, 860));
}

TEST(LiveSurface, StopsInTheMiddleOfItsWork) {
  const Volume volume = ball_of_bone();
  for (int n = 0; n < 5; ++n) {
    LiveSurface live(volume);
    live.volume_changed(volume, {volume.geometry().all_voxels()});
  }
}

}  // namespace
}  // namespace osteomill
