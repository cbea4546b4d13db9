#include "barrier_shell/near_points.h"

#include <random>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "barrier_shell/certificate.h"
#include "barrier_shell/near_kernel.h"
#include "bone_points/brick_points.h"
#include "tests/instruction_sets.h"
#include "tests/random.h"

namespace osteomill::barrier_shell {
namespace {

using testing_support::available_instruction_sets;
using testing_support::ForcedInstructionSet;
using testing_support::uniform;

// Points all around the tool, also beyond the shaft's end and below the burr, none of them in a core.
std::vector<ShellPoint> random_points(const Cores& cores, std::mt19937& bits) {
  std::vector<ShellPoint> points;
  while (points.size() < 700) {
    const Vec3 p(2 * uniform(bits, -1, 1), 2 * uniform(bits, -1, 1), 3.5 + 6 * uniform(bits, -1, 1));
    if (distance_to_ball(cores, p).distance_mm < 0.01) continue;
    if (distance_to_cylinder(cores, p).distance_mm < 0.01) continue;
    points.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()),
                      static_cast<float>(0.01 * (1.1 + uniform(bits, -1, 1)))});
  }
  return points;
}

struct Occupancy {
  MeasuredPoints ball{2048}, cylinder{2048};
  double ball_use, cylinder_use;
};

Occupancy found(const BrickPoints& points, const Cores& cores, const Barrier& barrier, const Vector6& move) {
  const Frame still = frame_of(Mat3::Identity(), Vec3::Zero());
  const GatherRegion region{cores, barrier.width_mm + 0.05, 0.01};
  NearPoints ball(2048), cylinder(2048);
  gather_near_ball(points, points.brick(0).first_chunk, still, region, ball);
  gather_near_cylinder(points, points.brick(0).first_chunk, still, region, cylinder);
  pad_last_lanes(ball);
  pad_last_lanes(cylinder);
  Occupancy f;
  measure_ball(ball, still, cores, barrier, f.ball);
  measure_cylinder(cylinder, still, cores, barrier, f.cylinder);
  f.ball_use = max_use_by_ball(f.ball, move, 1e-6);
  f.cylinder_use = max_use_by_cylinder(f.cylinder, move, 1e-6);
  return f;
}

bool same_bits(const EnergySum& a, const EnergySum& b) {
  return a.energy_Nmm == b.energy_Nmm && a.gradient == b.gradient && a.convex == b.convex &&
         a.rest == b.rest && a.touching == b.touching && a.nearest_mm == b.nearest_mm;
}

void expect_near(const EnergySum& a, const EnergySum& b) {
  constexpr double kRelative = 2e-4;  // single precision, and a steep barrier near the core
  EXPECT_EQ(a.touching, b.touching);
  EXPECT_NEAR(a.nearest_mm, b.nearest_mm, 1e-5);
  EXPECT_NEAR(a.energy_Nmm, b.energy_Nmm, kRelative * b.energy_Nmm);
  EXPECT_LE((a.gradient - b.gradient).norm(), kRelative * b.gradient.norm());
  const Matrix6 one = a.convex + a.rest, other = b.convex + b.rest;
  EXPECT_LE((one - other).norm(), kRelative * (b.convex.norm() + b.rest.norm()));
  EXPECT_GE(Eigen::SelfAdjointEigenSolver<Matrix6>(a.convex).eigenvalues().minCoeff(),
            -1e-3 * a.convex.norm());
}

TEST(NearPoints, AllInstructionSetsAreBitIdenticalAndMatchScalarSums) {
  std::mt19937 bits(12);
  const Barrier barrier{0.25, 3};
  ASSERT_GE(available_instruction_sets(near_kernel_targets()).size(), 1u);
  int on_ball = 0, on_cylinder = 0;
  for (const MillingTool& tool : {MillingTool{1.5, 1.0, 8}, MillingTool{0.8, 1.2, 6}, MillingTool{1, 1, 7}}) {
    const Cores cores = Cores::within(tool, 0.2);
    for (int n = 0; n < 20; ++n) {
      const std::vector<ShellPoint> all = random_points(cores, bits);
      PointRows rows(all.size());
      for (const ShellPoint& point : all) rows.add(point);
      BrickPoints points(1, 64);
      ASSERT_EQ(points.replace(0, rows), all.size());
      Vector6 move;
      move << 0.1 * Vec3(uniform(bits, -1, 1), uniform(bits, -1, 1), uniform(bits, -1, 1)),
          0.01 * Vec3(uniform(bits, -1, 1), uniform(bits, -1, 1), uniform(bits, -1, 1));
      EnergySum ball, cylinder;
      double ball_use = 0, cylinder_use = 0;
      for (const ShellPoint& p : all) {
        const Vec3 at(static_cast<double>(p.x_mm), static_cast<double>(p.y_mm), static_cast<double>(p.z_mm));
        const CoreDistance b = distance_to_ball(cores, at), c = distance_to_cylinder(cores, at);
        add_point(ball, static_cast<double>(p.area_mm2) * barrier.at(b.distance_mm), at, b);
        add_point(cylinder, static_cast<double>(p.area_mm2) * barrier.at(c.distance_mm), at, c);
        if (b.distance_mm < barrier.width_mm) {
          ball_use = std::max(ball_use, distance_used_by_ball(b.outward_T, move) / b.distance_mm);
        }
        if (c.distance_mm < barrier.width_mm) {
          cylinder_use = std::max(cylinder_use, distance_used(at, c.outward_T, move) / c.distance_mm);
        }
      }
      on_ball += ball.touching;
      on_cylinder += cylinder.touching;
      std::vector<Occupancy> fast;
      for (const std::int64_t target : available_instruction_sets(near_kernel_targets())) {
        const ForcedInstructionSet forced(target);
        fast.push_back(found(points, cores, barrier, move));
        EXPECT_TRUE(same_bits(fast.back().ball.sum, fast.front().ball.sum)) << hwy::TargetName(target);
        EXPECT_TRUE(same_bits(fast.back().cylinder.sum, fast.front().cylinder.sum))
            << hwy::TargetName(target);
        EXPECT_EQ(fast.back().ball_use, fast.front().ball_use) << hwy::TargetName(target);
        EXPECT_EQ(fast.back().cylinder_use, fast.front().cylinder_use) << hwy::TargetName(target);
      }
      expect_near(fast.front().ball.sum, ball);
      expect_near(fast.front().cylinder.sum, cylinder);
      EXPECT_GE(fast.front().ball_use, ball_use * (1 - 1e-3));
      EXPECT_GE(fast.front().cylinder_use, cylinder_use * (1 - 1e-3));
    }
  }
  EXPECT_GT(on_ball, 300);
  EXPECT_GT(on_cylinder, 2000);
}

}  // namespace
}  // namespace osteomill::barrier_shell
