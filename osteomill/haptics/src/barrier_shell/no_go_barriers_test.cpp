#include "barrier_shell/no_go_barriers.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "barrier_shell/barrier_shell.h"
#include "tests/random.h"
#include "tests/shapes.h"

namespace osteomill::barrier_shell {
namespace {

using testing_support::random_vector;
using testing_support::uniform;

constexpr double kStep_s = 1e-3;

// A bent structure of voxels, like a nerve; the distance from its cubes is found by searching all of them.
struct Nerve {
  GridGeometry scan = testing_support::centred_cube(60, 0.25);
  VoxelSet voxels{VoxelBox{{10, 10, 10}, {50, 50, 50}}};
  std::vector<VoxelIndex> list;

  Nerve() {
    for (double t = 0; t < 1; t += 0.004) {
      const VoxelIndex middle{14 + static_cast<int>(30 * t), 30 + static_cast<int>(8 * std::sin(5 * t)),
                              20 + static_cast<int>(14 * t * t)};
      for_each(VoxelBox{middle, {middle.i + 2, middle.j + 2, middle.k + 2}}, [&](const VoxelIndex& v) {
        if (!voxels.contains(v)) list.push_back(v);
        voxels.insert(v);
      });
    }
  }
  double distance_mm(const Vec3& point_W) const {
    const Vec3 point = scan.voxel_from_world(point_W);
    double least_mm = std::numeric_limits<double>::infinity();
    for (const VoxelIndex& v : list) {
      const Vec3 outside = ((point - Vec3(v.i, v.j, v.k)).cwiseAbs().array() - 0.5).cwiseMax(0);
      least_mm = std::min(least_mm, outside.cwiseProduct(scan.spacing_mm).norm());
    }
    return least_mm;
  }
};

// Bone far below the structures.
std::unique_ptr<Volume> with_structures(NoGoDistances structures, double bone_below_mm = -6.5) {
  auto volume = std::make_unique<Volume>(testing_support::shape_volume(
      testing_support::centred_cube(60, 0.25), testing_support::plane({0, 0, bone_below_mm}, Vec3::UnitZ())));
  volume->set_no_go(std::make_shared<NoGoDistances>(std::move(structures)));
  return volume;
}

MillingTool tool_of(double burr_radius_mm) {
  return {burr_radius_mm, 0.6 * burr_radius_mm, 25};
}

using Distance = std::function<double(const Vec3&)>;
struct Kind {
  std::string name;
  StructureDistance structure;
  Distance distance_mm;
};

std::vector<Kind> kinds() {
  const auto nerve = std::make_shared<Nerve>();
  const SphereShape sphere{{0.3, -0.2, 0.4}, 1.1};
  const BoxShape box{{-1, -2, -0.5}, {1, 1.5, 0.5}};
  const CylinderShape cylinder{{-2, 0.2, 0}, {1.5, 0.5, 1}, 0.75};
  return {{"sphere", StructureDistance(sphere), [=](const Vec3& p) { return distance_mm(sphere, p); }},
          {"box", StructureDistance(box), [=](const Vec3& p) { return distance_mm(box, p); }},
          {"cylinder", StructureDistance(cylinder), [=](const Vec3& p) { return distance_mm(cylinder, p); }},
          {"voxels", StructureDistance(nerve->voxels, nerve->scan),
           [=](const Vec3& p) { return nerve->distance_mm(p); }}};
}

TEST(NoGoBarriers, KeepTheBurrAtGuardDistanceWithin50umInRandomPushes) {
  std::mt19937 random(7);
  for (const Kind& kind : kinds()) {
    double nearest_mm = std::numeric_limits<double>::infinity(), strongest_N = 0;
    int pushed = 0;
    for (int setup = 0; setup < 25; ++setup) {
      const double guard_mm = uniform(random, 0, 1.5), burr_mm = uniform(random, 0.3, 2);
      const auto volume = with_structures({{kind.structure, guard_mm}});
      BarrierShell algorithm{Settings{}};
      algorithm.prepare({volume.get(), tool_of(burr_mm)});
      for (int push = 0; push < 100; ++push) {
        // From anywhere outside the guard, at up to 300 mm/s, to a target beyond or beside the structure, far
        // enough for the coupling to reach 20 N.
        const Vec3 out = random_vector(random).normalized();
        Vec3 from_W = 9 * out;
        while (kind.distance_mm(from_W) > burr_mm + guard_mm + 0.3) from_W -= 0.1 * out;
        from_W += 0.1 * out;
        const Vec3 to_W =
            from_W - uniform(random, 0.3, 12) * (out + 0.8 * random_vector(random)).normalized();
        const double step_mm = uniform(random, 0.01, 0.3);
        const int ticks = static_cast<int>((to_W - from_W).norm() / step_mm) + 20;
        algorithm.reset();
        const Quat turn = quaternion_from_rotation_vector(0.5 * random_vector(random));
        for (int n = 0; n < std::min(ticks, 120); ++n) {
          const double moved_mm = std::min(n * step_mm, (to_W - from_W).norm());
          const Pose X_WD{from_W + moved_mm * (to_W - from_W).normalized(), turn};
          const HapticStep step = algorithm.step(X_WD, kStep_s);
          if (step.contacts > 0) ++pushed;
          strongest_N = std::max(strongest_N, step.wrench.force_N.norm());
          const double margin_mm = kind.distance_mm(step.X_WT.position_mm) - burr_mm - guard_mm;
          nearest_mm = std::min(nearest_mm, margin_mm);
          ASSERT_GE(margin_mm, -0.05) << kind.name << ", push " << push << ", tick " << n;
        }
      }
    }
    EXPECT_GT(pushed, 10000) << kind.name;
    EXPECT_LT(nearest_mm, 0.02) << kind.name;
    EXPECT_GT(strongest_N, 10) << kind.name;
    EXPECT_LE(strongest_N, 20 + 1e-9) << kind.name;
  }
}

TEST(NoGoBarriers, AddNoEnergyOnAClosedPathBeyondTheSamplingError) {
  std::mt19937 random(3);
  const Settings settings;
  for (const Kind& kind : kinds()) {
    const auto volume = with_structures({{kind.structure, 0.5}});
    BarrierShell algorithm{settings};
    algorithm.prepare({volume.get(), tool_of(1)});
    for (int loop = 0; loop < 20; ++loop) {
      // A loop through the structure and back to its start, in free space.
      Vec3 begin_W = 7 * random_vector(random).normalized();
      begin_W.z() = std::abs(begin_W.z());
      std::vector<Vec3> corners{begin_W};
      for (int n = 0; n < 4; ++n) corners.push_back(3 * random_vector(random));
      corners.push_back(begin_W);
      double given_Nmm = 0, lent_Nmm = 0;
      bool is_touched = false;
      Vec3 before_W = begin_W, force_N = Vec3::Zero();
      algorithm.reset();
      const auto go_to = [&](const Vec3& place_W) {
        const Vec3 move_mm = place_W - before_W;
        given_Nmm += force_N.dot(move_mm);
        lent_Nmm += 0.5 * settings.translational_stiffness_N_per_mm * move_mm.squaredNorm();
        before_W = place_W;
        const HapticStep step = algorithm.step({place_W, Quat::Identity()}, kStep_s);
        force_N = step.wrench.force_N;
        is_touched = is_touched || step.contacts > 0;
      };
      for (std::size_t n = 1; n < corners.size(); ++n) {
        const Vec3 way = corners[n] - corners[n - 1];
        const int ticks = static_cast<int>(way.norm() / 0.02);
        for (int tick = 1; tick <= ticks; ++tick)
          go_to(corners[n - 1] + static_cast<double>(tick) / ticks * way);
      }
      EXPECT_LE(given_Nmm, lent_Nmm + 1e-6) << kind.name << ", loop " << loop;
      if (loop == 0) {
        EXPECT_TRUE(is_touched) << kind.name;
      }
    }
    EXPECT_EQ(algorithm.counts().energy_rises, 0u) << kind.name;
  }
}

TEST(NoGoBarriers, IgnoreABurrThatStartsInsideUntilItHasLeft) {
  const SphereShape sphere{{0, 0, 0}, 1};
  const auto volume = with_structures({{StructureDistance(sphere), 1.0}});
  BarrierShell algorithm{Settings{}};
  algorithm.prepare({volume.get(), tool_of(1)});
  HapticStep step;
  for (int n = 0; n < 100; ++n) step = algorithm.step({{0, 0, 2.2}, Quat::Identity()}, kStep_s);
  EXPECT_EQ(step.wrench.force_N, Vec3::Zero());
  EXPECT_EQ(step.X_WT.position_mm, Vec3(0, 0, 2.2));
  for (int n = 0; n < 200; ++n) step = algorithm.step({{0, 0, 2.2 + 0.01 * n}, Quat::Identity()}, kStep_s);
  EXPECT_EQ(step.wrench.force_N, Vec3::Zero());
  for (int n = 0; n < 400; ++n)
    step = algorithm.step({{0, 0, 4.2 - 0.01 * std::min(n, 250)}, Quat::Identity()}, kStep_s);
  EXPECT_NEAR(step.X_WT.position_mm.z(), 3, 0.05);
  EXPECT_GT(step.wrench.force_N.z(), 1);
  EXPECT_EQ(step.burr_force_W_N, Vec3::Zero());
}

TEST(NoGoBarriers, LeaveOutputBitIdenticalForUnguardedStructures) {
  const SphereShape sphere{{0, 0, -4}, 1};
  const auto plain = with_structures({}, -3), watched = with_structures({{StructureDistance(sphere)}}, -3);
  BarrierShell without{Settings{}}, with{Settings{}};
  without.prepare({plain.get(), {}});
  with.prepare({watched.get(), {}});
  for (int n = 0; n < 600; ++n) {
    const Pose X_WD{{0.002 * n, 0, 0.5 - 0.01 * std::min(n, 300)}, Quat::Identity()};
    const HapticStep a = without.step(X_WD, kStep_s), b = with.step(X_WD, kStep_s);
    ASSERT_EQ(a.wrench.force_N, b.wrench.force_N);
    ASSERT_EQ(a.wrench.torque_Nmm, b.wrench.torque_Nmm);
    ASSERT_EQ(a.X_WT.position_mm, b.X_WT.position_mm);
  }
}

}  // namespace
}  // namespace osteomill::barrier_shell
