#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "tests/shapes.h"
#include <gtest/gtest.h>

#include "osteomill/haptics/line_proxy/line_proxy.h"

// Algorithm 1 against a hand: a handle of 0.3 kg and 3e-4 kg m^2 in a spring of 500 N/m and 5 N s/m (0.5 N
// m/rad) that pushes no harder than its limit, 20 substeps a tick.
namespace osteomill::line_proxy {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

constexpr double kTick_s = 1e-3;

struct Hand {
  Pose X_WD;
  Pose target;
  double push_limit_N = 10.0;
  Vec3 velocity = Vec3::Zero();
  Vec3 turning = Vec3::Zero();

  static Vec3 limited(const Vec3& vector, double limit) {
    return vector.norm() <= limit ? vector : Vec3(vector * (limit / vector.norm()));
  }
  void advance(const Wrench& wrench, const Vec3& target_velocity) {
    constexpr int kSubsteps = 20;
    constexpr double kDt_s = kTick_s / kSubsteps;
    for (int n = 0; n < kSubsteps; ++n) {
      const Vec3 stretch = target.position_mm - X_WD.position_mm;
      // A hand does not run far ahead of what it cannot move.
      if (0.5 * stretch.norm() < 1.2 * push_limit_N) target.position_mm += kDt_s * target_velocity;
      const Vec3 force = limited(0.5 * stretch, push_limit_N) - 0.005 * velocity + wrench.force_N;
      const Vec3 twist = rotation_vector(target.orientation * X_WD.orientation.conjugate());
      const Vec3 torque = limited(500.0 * twist, 10.0 * push_limit_N) - 5.0 * turning + wrench.torque_Nmm;
      velocity += kDt_s * 1000.0 / 0.3 * force;
      turning += kDt_s / 0.3 * torque;
      X_WD.position_mm += kDt_s * velocity;
      X_WD.orientation = (quaternion_from_rotation_vector(kDt_s * turning) * X_WD.orientation).normalized();
    }
  }
};

LineProxy steady_on(const Volume& volume) {
  LineProxy algorithm(Settings::defaults(Mode::steady));
  algorithm.prepare({&volume, MillingTool{}});
  return algorithm;
}

double past_surface_mm(const Pose& X_WT, const std::function<double(const Vec3&)>& signed_distance_mm) {
  const MillingTool tool;
  double past = tool.burr_radius_mm - signed_distance_mm(X_WT.position_mm);
  for (double z = 1.2; z <= tool.shaft_length_mm; z += 0.2) {
    past = std::max(past, tool.shaft_radius_mm - signed_distance_mm(X_WT * Vec3(0, 0, z)));
  }
  return past;
}

Vec3 random_unit(std::mt19937_64& random) {
  const auto number = [&] { return static_cast<double>(random() >> 11) / 4503599627370496.0 - 1.0; };
  for (;;) {
    const Vec3 vector(number(), number(), number());
    if (vector.norm() > 0.1 && vector.norm() < 1.0) return vector.normalized();
  }
}

// The tool stands on the bone tip first, leaning up to 60 degrees, and is pushed in.
TEST(LineProxyHand, NoPushFallsThrough) {
  const auto plane_mm = plane(Vec3::Zero(), Vec3(0.1, 0.2, 1));
  // So large that no hand pulls the tip through its centre to the other side.
  const Vec3 centre(0, 0, -32);
  const auto ball_mm = ball(centre, 40.0);
  const Volume plane_bone = shape_volume(centred_cube(100, 0.5), plane_mm);
  const Volume ball_bone = shape_volume(centred_cube(100, 0.5), ball_mm);
  std::mt19937_64 random(11);
  const auto between = [&](double a, double b) {
    return a + (b - a) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  for (int trial = 0; trial < 60; ++trial) {
    const bool on_ball = trial % 2 == 1;
    const Vec3 normal =
        (on_ball ? Vec3(Vec3::UnitZ() + 0.2 * random_unit(random)) : Vec3(0.1, 0.2, 1)).normalized();
    Vec3 shaft = random_unit(random);
    if (shaft.dot(normal) < 0) shaft = -shaft;
    if (shaft.dot(normal) < 0.5) shaft = (shaft + normal).normalized();
    const Vec3 direction = (-normal + 0.15 * random_unit(random)).normalized();
    const Vec3 contact = on_ball ? Vec3(centre + 40.0 * normal) : Vec3::Zero();
    Hand hand;
    hand.X_WD = {contact - 3.0 * direction, smallest_rotation(Vec3::UnitZ(), shaft)};
    hand.target = hand.X_WD;
    hand.push_limit_N = between(2.0, 10.0);
    const double speed_mm_s = between(20.0, 300.0);
    LineProxy algorithm = steady_on(on_ball ? ball_bone : plane_bone);
    HapticStep step;
    const int push_ticks = static_cast<int>(6000.0 / speed_mm_s) + 100;
    for (int n = 0; n < push_ticks + 300; ++n) {
      step = algorithm.step(hand.X_WD, kTick_s);
      const Vec3 pull = n < push_ticks ? Vec3(speed_mm_s * direction) : Vec3::Zero();
      hand.advance(make_safe(step.wrench, WrenchLimits{}).wrench, pull);
    }
    EXPECT_LT(past_surface_mm(step.X_WT, on_ball ? ball_mm : plane_mm), 0.3) << trial;
    EXPECT_GT(step.wrench.force_N.norm(), 1.0) << trial;
  }
}

// Any part of the tool first: its flank, or the end of its shaft with the burr hanging in the air.
TEST(LineProxyHand, NoPushOfTheShaftFallsThrough) {
  const auto plane_mm = plane(Vec3::Zero(), Vec3(0.1, 0.2, 1));
  const Volume bone = shape_volume(centred_cube(120, 0.5), plane_mm);
  const Vec3 normal = Vec3(0.1, 0.2, 1).normalized();
  std::mt19937_64 random(5);
  const auto between = [&](double a, double b) {
    return a + (b - a) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  for (int trial = 0; trial < 30; ++trial) {
    Vec3 shaft = random_unit(random);
    if (shaft.dot(normal) > 0) shaft = -shaft;
    const Vec3 direction = (-normal + 0.15 * random_unit(random)).normalized();
    Hand hand;
    hand.X_WD.orientation = smallest_rotation(Vec3::UnitZ(), shaft);
    // Such that the tool's end is 2 mm above the bone.
    hand.X_WD.position_mm = -MillingTool{}.shaft_length_mm * shaft + 3.0 * normal;
    hand.target = hand.X_WD;
    hand.push_limit_N = between(2.0, 10.0);
    const double speed_mm_s = between(20.0, 300.0);
    LineProxy algorithm = steady_on(bone);
    HapticStep step;
    for (int n = 0; n < 1200; ++n) {
      step = algorithm.step(hand.X_WD, kTick_s);
      hand.advance(make_safe(step.wrench, WrenchLimits{}).wrench,
                   n < 300 ? Vec3(speed_mm_s * direction) : Vec3::Zero());
    }
    // A circle round the shaft reaches this far below its middle, less than its radius where it lies flat.
    const Vec3 shown = shaft_direction(step.X_WT);
    const double reach_mm = MillingTool{}.shaft_radius_mm * normal.cross(shown).norm();
    const Vec3 end_W = step.X_WT * Vec3(0, 0, MillingTool{}.shaft_length_mm);
    EXPECT_LT(reach_mm - plane_mm(end_W), 0.3) << trial;
    EXPECT_LT(MillingTool{}.burr_radius_mm - plane_mm(step.X_WT.position_mm), 0.3) << trial;
    EXPECT_GT(step.wrench.force_N.norm(), 0.5) << trial;
  }
}

TEST(LineProxyHand, APressedHandComesToRest) {
  const Volume bone = shape_volume(centred_cube(60, 0.25), plane(Vec3::Zero(), Vec3(0.1, 0.2, 1)));
  LineProxy algorithm = steady_on(bone);
  Hand hand;
  hand.X_WD.position_mm = {0, 0, 2};
  hand.target = hand.X_WD;
  hand.push_limit_N = 3.0;
  double largest_step_N = 0;
  Vec3 force_before = Vec3::Zero();
  for (int n = 0; n < 3000; ++n) {
    const HapticStep step = algorithm.step(hand.X_WD, kTick_s);
    if (n >= 2000) largest_step_N = std::max(largest_step_N, (step.wrench.force_N - force_before).norm());
    force_before = step.wrench.force_N;
    hand.advance(step.wrench, n < 600 ? Vec3(0, 0, -10) : Vec3::Zero());
  }
  EXPECT_GT(force_before.norm(), 1.0);
  EXPECT_LT(largest_step_N, 1e-3);
  EXPECT_LT(hand.velocity.norm(), 0.1);
}

// A drop on bone in a weak hand must not gain.
TEST(LineProxyHand, ADropReboundsWithLessEnergy) {
  const Volume bone = shape_volume(centred_cube(60, 0.25), plane(Vec3::Zero(), Vec3::UnitZ()));
  for (const double stiffness : {2.0, 5.0}) {
    Settings settings = Settings::defaults(Mode::steady);
    settings.stiffness_N_per_mm = stiffness;
    LineProxy algorithm(settings);
    algorithm.prepare({&bone, MillingTool{}});
    double height_mm = 1.0;
    double speed_mm_s = -100.0;
    double rebound_mm_s = 0.0;
    for (int n = 0; n < 400; ++n) {
      const double force_N =
          algorithm.step({Vec3(0, 0, height_mm), Quat::Identity()}, kTick_s).wrench.force_N.z();
      for (int substep = 0; substep < 20; ++substep) {
        speed_mm_s += 50e-6 * 1000.0 / 0.3 * (force_N - 0.0055 * speed_mm_s);
        height_mm += 50e-6 * speed_mm_s;
      }
      rebound_mm_s = std::max(rebound_mm_s, speed_mm_s);
    }
    EXPECT_GT(rebound_mm_s, 10.0);
    EXPECT_LT(rebound_mm_s, 100.0) << stiffness;
  }
}

}  // namespace
}  // namespace osteomill::line_proxy
