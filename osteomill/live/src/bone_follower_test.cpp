#include "osteomill/live/bone_follower.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "osteomill/milling/burr_mill.h"
#include "osteomill/visual/surface_mesh.h"

#include "tests/shapes.h"
#include "tests/support/mesh_checks.h"

namespace osteomill {
namespace {

using namespace std::chrono_literals;
using testing_support::ball;
using testing_support::centred_cube;
using testing_support::mesh_of;
using testing_support::mesh_surface;
using testing_support::shape_volume;
using testing_support::SurfaceMesh;

Volume ball_of_bone() {
  return shape_volume(centred_cube(51, 0.25), ball(Vec3::Zero(), 5.0));
}

// A burr moving around on the ball, pressed in.
class Miller {
 public:
  explicit Miller(Volume& volume) : mill_(volume, 1.5, {0.0, 1000.0}, {}) {}
  VolumeChange tick() {
    angle_ += 0.002;
    const Vec3 centre = (6.3 - 0.2 * angle_) * Vec3(std::cos(angle_), std::sin(angle_), 0.2).normalized();
    return mill_.step(centre, {0, 0, -4.0}, 1e-3).change;
  }

 private:
  BurrMill mill_;
  double angle_ = 0;
};

// Collects the changed bricks, as a window would.
struct Collected {
  explicit Collected(const SurfaceBricks& layout) : mesh{layout, {}} { mesh.bricks.resize(layout.count()); }
  void take(const ChangedBricks& changed) {
    for (const auto& [number, brick] : changed) mesh.bricks[number] = mesh_of(brick);
  }
  SurfaceMesh mesh;
};

bool same_surface(const SurfaceMesh& mesh, const Volume& volume, double isovalue) {
  return mesh.bricks == mesh_surface({volume.grid(), volume.ranges(), isovalue}).bricks;
}

// Ticks without milling until the surface matches the volume, for at most 20 s.
bool settles(BoneFollower& follower, Collected& collected, const Volume& volume, double isovalue) {
  for (int n = 0; n < 2000; ++n) {
    for (int tick = 0; tick < 10; ++tick) follower.bone_changed(volume, {});
    collected.take(follower.take_changed_bricks());
    if (n % 10 == 9 && same_surface(collected.mesh, volume, isovalue)) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

CopyOnWriteFloats densities_of(const BoneFollower& follower) {
  CopyOnWriteFloats densities;
  follower.read([&](const Volume& copy) { densities = copy.grid().densities(); });
  return densities;
}

// Every density must lie within the copy's ranges; otherwise the surface would have holes.
bool ranges_hold(const BoneFollower& follower) {
  bool hold = true;
  follower.read([&](const Volume& copy) {
    const BlockRanges exact(copy.grid());
    const auto& dims = exact.dims();
    for (int bk = 0; bk < dims[2]; ++bk) {
      for (int bj = 0; bj < dims[1]; ++bj) {
        for (int bi = 0; bi < dims[0]; ++bi) {
          const auto& held = copy.ranges().at(bi, bj, bk);
          const auto& range = exact.at(bi, bj, bk);
          hold = hold && held.min <= range.min && held.max >= range.max;
        }
      }
    }
  });
  return hold;
}

// A ball of bone with its follower, milled without other threads than the follower's own.
class BoneFollowerTest : public ::testing::Test {
 protected:
  void mill(int ticks) {
    for (int tick = 0; tick < ticks; ++tick) follower_.bone_changed(*bone_, miller_->tick());
  }
  void catch_up() {
    while (!follower_.catch_up()) follower_.bone_changed(*bone_, {});
  }
  // Continues milling on the prepared bone, as a live session does.
  void swap(const BoneFollower::NextBone& next) {
    EXPECT_NE(bone_, next.bone);
    bone_ = next.bone;
    follower_.swap();
    miller_.emplace(*bone_);
  }
  const CopyOnWriteFloats& now() const { return bone_->grid().densities(); }

  std::shared_ptr<Volume> bone_ = std::make_shared<Volume>(ball_of_bone());
  std::optional<Miller> miller_{*bone_};
  BoneFollower follower_{bone_};
  Collected collected_{follower_.layout()};
};

TEST_F(BoneFollowerTest, EqualsTheBoneOnceCaughtUp) {
  const std::uint64_t version = follower_.version();
  mill(400);
  catch_up();
  EXPECT_EQ(densities_of(follower_), now());
  EXPECT_NE(now(), ball_of_bone().grid().densities());
  EXPECT_GT(follower_.version(), version);
  EXPECT_TRUE(ranges_hold(follower_));
  EXPECT_TRUE(settles(follower_, collected_, *bone_, 500));
}

TEST_F(BoneFollowerTest, LosesNoChangesWhenItsQueueIsFull) {
  const Volume before = *bone_;
  // More bricks than the queue holds, repeatedly, while the reader blocks the follower.
  follower_.read([&](const Volume&) {
    for (int n = 0; n < 20; ++n) {
      mill(50);
      for (int tick = 0; tick < 100; ++tick) {
        follower_.bone_changed(*bone_, {bone_->geometry().all_voxels()});
      }
    }
  });
  EXPECT_FALSE(follower_.catch_up());
  catch_up();
  EXPECT_EQ(densities_of(follower_), now());
  EXPECT_NE(now(), before.grid().densities());
}

TEST_F(BoneFollowerTest, UndoesCutsInBothCopies) {
  const CopyOnWriteFloats untouched = now();
  follower_.begin_cut(0);
  mill(300);
  catch_up();
  const CopyOnWriteFloats after_first = now();
  follower_.begin_cut(2.5);
  mill(300);
  catch_up();
  EXPECT_EQ(follower_.cuts(), 2u);

  const BoneFollower::NextBone next = follower_.without_last_cut(1.5);
  EXPECT_EQ(next.removed_mm3, 2.5);
  swap(next);
  EXPECT_EQ(now(), after_first);
  EXPECT_EQ(densities_of(follower_), after_first);
  EXPECT_TRUE(ranges_hold(follower_));
  EXPECT_TRUE(settles(follower_, collected_, *bone_, 500));

  // Milling continues in the other one, and all cuts are undone.
  mill(200);
  catch_up();
  EXPECT_EQ(densities_of(follower_), now());
  EXPECT_NE(now(), after_first);
  EXPECT_TRUE(follower_.is_touched());
  swap(follower_.without_all_cuts());
  EXPECT_EQ(now(), untouched);
  EXPECT_EQ(densities_of(follower_), untouched);
  EXPECT_FALSE(follower_.is_touched());
  EXPECT_TRUE(ranges_hold(follower_));
  EXPECT_TRUE(settles(follower_, collected_, *bone_, 500));
}

TEST_F(BoneFollowerTest, DiscardNextRestoresDensitiesAndCuts) {
  follower_.begin_cut(0);
  mill(300);
  catch_up();
  for (const bool all : {false, true}) {
    if (all) {
      follower_.without_all_cuts();
    } else {
      follower_.without_last_cut(1.5);
    }
    EXPECT_NE(densities_of(follower_), now());
    follower_.discard_next();
    EXPECT_EQ(densities_of(follower_), now());
    EXPECT_EQ(follower_.cuts(), 1u);
    EXPECT_TRUE(follower_.is_touched());
  }
  follower_.with_isovalue(300, 0, 0);
  follower_.discard_next();
  EXPECT_EQ(follower_.cuts(), 1u);
  EXPECT_TRUE(settles(follower_, collected_, *bone_, 500));
}

TEST_F(BoneFollowerTest, ChangesTheIsovalueOfBothCopies) {
  mill(300);
  catch_up();
  const CopyOnWriteFloats milled = now();
  swap(follower_.with_isovalue(700, 0, 1.5));
  EXPECT_EQ(bone_->isovalue(), 700);
  EXPECT_EQ(now(), milled);
  follower_.read([&](const Volume& copy) { EXPECT_EQ(copy.isovalue(), 700); });
  EXPECT_TRUE(settles(follower_, collected_, *bone_, 700));
  EXPECT_THROW(follower_.with_isovalue(std::nan(""), 0, 0), std::invalid_argument);
}

// Ticks at full speed on one thread, drawing on another, meshing on a third; also run under the thread
// sanitizer.
TEST(BoneFollower, MatchesTheBoneAfterMillingAtFullSpeed) {
  const auto bone = std::make_shared<Volume>(ball_of_bone());
  Volume& volume = *bone;
  BoneFollower live(bone);
  Collected collected(live.layout());
  std::atomic<bool> done{false};
  std::thread haptic([&] {
    Miller miller(volume);
    for (int tick = 0; tick < 2000; ++tick) live.bone_changed(volume, miller.tick());
    done = true;
  });
  while (!done) {
    collected.take(live.take_changed_bricks());
    live.begin_cut(0);
    live.read([](const Volume& copy) { EXPECT_LE(copy.grid()[VoxelIndex{}], 1000); });
    std::this_thread::sleep_for(1ms);
  }
  haptic.join();
  EXPECT_TRUE(settles(live, collected, volume, 500));
}

TEST(BoneFollower, FollowsTheIsovalueWhileMilling) {
  const auto bone = std::make_shared<Volume>(ball_of_bone());
  Volume& volume = *bone;
  BoneFollower live(bone);
  Collected collected(live.layout());
  Miller miller(volume);
  for (int tick = 0; tick < 600; ++tick) {
    live.bone_changed(volume, miller.tick());
    if (tick % 40 == 0) live.show_isovalue(300 + tick);
    if (tick % 10 == 0) collected.take(live.take_changed_bricks());
  }
  EXPECT_TRUE(settles(live, collected, volume, 860));
}

TEST(BoneFollower, StopsPendingWorkOnDestruction) {
  const auto bone = std::make_shared<Volume>(ball_of_bone());
  for (int n = 0; n < 5; ++n) {
    {
      BoneFollower live(bone);
      live.bone_changed(*bone, {bone->geometry().all_voxels()});
      EXPECT_FALSE(live.catch_up()) << "there was nothing left to do";
    }
    EXPECT_EQ(bone.use_count(), 1) << "something goes on with the bone";
    EXPECT_EQ(bone->change_hash(), 0u);
  }
}

}  // namespace
}  // namespace osteomill
