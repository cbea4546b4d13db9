#include "osteomill/study/measure_passivity.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "osteomill/study/probe_bones.h"

namespace osteomill {
namespace {

constexpr double kRadius_mm = 1.5;

// The textbook wall: a spring along its normal.
class IdealWall final : public HapticAlgorithm {
 public:
  explicit IdealWall(double stiffness_N_per_mm, double damping_Ns_per_mm = 0)
      : stiffness_(stiffness_N_per_mm), damping_(damping_Ns_per_mm) {}

  void prepare(const AlgorithmInputs& /*inputs*/) override {}
  HapticStep step(const Pose& X_WD, double dt_s) noexcept override {
    HapticStep step;
    const double depth_mm = kRadius_mm - X_WD.position_mm.z();
    const double speed_mm_s = (depth_mm - last_depth_mm_) / dt_s;
    last_depth_mm_ = depth_mm;
    if (depth_mm > 0) step.wrench.force_N.z() = stiffness_ * depth_mm + damping_ * speed_mm_s;
    return step;
  }
  void volume_changed(const VolumeChange& /*change*/) noexcept override {}
  void reset() noexcept override {}
  int sample_point_count() const override { return 1; }

 private:
  double stiffness_;
  double damping_;
  double last_depth_mm_ = 0;
};

WallPress device(double damping_Ns_per_mm, double delay_s) {
  WallPress press;
  press.damping_Ns_per_mm = damping_Ns_per_mm;
  press.handle.force_delay_s = delay_s;
  return press;
}

StiffnessLimit ideal_limit(const WallPress& press) {
  const auto press_at = [&](double stiffness) {
    IdealWall wall(stiffness);
    return press_on_wall(wall, kRadius_mm, press);
  };
  return seek_stiffness_limit(press_at, 1.0);
}

// Returns the stiffness at which a mass on a damper and a spring, whose force is late by `delay_s` + half a
// tick, oscillates forever: K cos(w t) = m w^2, K sin(w t) = b w. The rule 2 b / (T + 2 tau) is its limit for
// slow oscillations.
double exact_limit_N_per_mm(const WallPress& press) {
  const double late_s = press.handle.force_delay_s + 0.5 * press.tick_s;
  const double rate = 1e3 * press.damping_Ns_per_mm / press.handle.mass_kg;
  double low = 0;
  double high = 0.5 * std::numbers::pi;
  for (int n = 0; n < 60; ++n) {
    const double x = 0.5 * (low + high);
    (x * std::tan(x) < rate * late_s ? low : high) = x;
  }
  return press.damping_Ns_per_mm * low / std::sin(low) / late_s;
}

TEST(Passivity, LimitOfAnIdealSpringMatchesTheRule) {
  for (const TrialSettings& setup : passivity_cases({algorithm_named("line-proxy")})) {
    const double damping = setup.device_damping_Ns_per_mm;
    const double delay_s = setup.hand_and_device.handle.force_delay_s;
    const WallPress press = device(damping, delay_s);
    const StiffnessLimit limit = ideal_limit(press);
    const double rule = passive_stiffness_rule_N_per_mm(damping, 1e-3, delay_s);
    const double exact = exact_limit_N_per_mm(press);
    EXPECT_EQ(limit.kind, StiffnessLimit::Kind::found);
    EXPECT_NEAR(limit.stiffness_N_per_mm / exact, 1, 0.05) << "b " << damping << " delay " << delay_s;
    EXPECT_NEAR(limit.stiffness_N_per_mm / rule, 1, 0.08);
    EXPECT_NEAR(limit.felt_N_per_mm / limit.stiffness_N_per_mm, 1, 1e-6);
  }
}

TEST(Passivity, NoStiffnessIsPassiveOnADeviceWithoutDamping) {
  EXPECT_EQ(ideal_limit(device(0, 0.3e-3)).kind, StiffnessLimit::Kind::below_all);
}

TEST(Passivity, MotionYieldsOnAWallThatIsTooSoft) {
  // It would carry the force only at 5 mm.
  IdealWall soft(0.1);
  EXPECT_EQ(press_on_wall(soft, kRadius_mm, device(0.005, 0)).motion, WallMotion::yields);
  IdealWall none(0);
  EXPECT_EQ(press_on_wall(none, kRadius_mm, device(0.005, 0)).motion, WallMotion::yields);
}

TEST(Passivity, MotionPersistsIfTheDeviceIsTooWeakForTheWall) {
  WallPress press = device(0.005, 0.3e-3);
  press.handle.limits.force_N = 0.3;
  IdealWall wall(1);
  EXPECT_EQ(press_on_wall(wall, kRadius_mm, press).motion, WallMotion::persists);
}

TEST(Passivity, MotionDecaysOnAnOverdampedDevice) {
  IdealWall wall(0.5);
  EXPECT_EQ(press_on_wall(wall, kRadius_mm, device(0.1, 0)).motion, WallMotion::decays);
}

// A force that jumps at the surface makes the handle oscillate without growth: not passive either.
class Relay final : public HapticAlgorithm {
 public:
  void prepare(const AlgorithmInputs& /*inputs*/) override {}
  HapticStep step(const Pose& X_WD, double /*dt_s*/) noexcept override {
    HapticStep step;
    const double depth_mm = kRadius_mm - X_WD.position_mm.z();
    step.wrench.force_N.z() = depth_mm > 0.5 ? 2 : depth_mm > 0 ? 0.5 * depth_mm : 0;
    return step;
  }
  void volume_changed(const VolumeChange& /*change*/) noexcept override {}
  void reset() noexcept override {}
  int sample_point_count() const override { return 1; }
};

TEST(Passivity, MotionPersistsInALimitCycle) {
  Relay relay;
  EXPECT_EQ(press_on_wall(relay, kRadius_mm, device(0.002, 2e-3)).motion, WallMotion::persists);
}

TEST(Passivity, MotionDoesNotDecayIfTheForceIsNotFinite) {
  class Broken final : public HapticAlgorithm {
   public:
    void prepare(const AlgorithmInputs& /*inputs*/) override {}
    HapticStep step(const Pose& X_WD, double /*dt_s*/) noexcept override {
      HapticStep step;
      const double depth_mm = kRadius_mm - X_WD.position_mm.z();
      step.wrench.force_N.z() = std::max(0.0, depth_mm);
      // Only after the handle has been released.
      if (++steps_ > 300) step.wrench.force_N.z() = std::numeric_limits<double>::quiet_NaN();
      return step;
    }
    void volume_changed(const VolumeChange& /*change*/) noexcept override {}
    void reset() noexcept override {}
    int sample_point_count() const override { return 1; }

   private:
    int steps_ = 0;
  };
  Broken broken;
  EXPECT_NE(press_on_wall(broken, kRadius_mm, device(0.005, 0)).motion, WallMotion::decays);
}

TEST(Passivity, SearchFindsTheLimitOrReportsBelowOrAboveAll) {
  const auto limit_at = [](double true_limit, double softest, double start) {
    return seek_stiffness_limit(
        [=](double k) {
          return WallPressResult{k < softest      ? WallMotion::yields
                                 : k < true_limit ? WallMotion::decays
                                                  : WallMotion::persists,
                                 0.5 * k};
        },
        start);
  };
  for (const double start : {0.01, 1.0, 7.0, 1000.0}) {
    const StiffnessLimit limit = limit_at(7, 0.3, start);
    EXPECT_EQ(limit.kind, StiffnessLimit::Kind::found) << start;
    EXPECT_LT(limit.stiffness_N_per_mm, 7) << start;
    EXPECT_GT(1.03 * limit.stiffness_N_per_mm, 7) << start;
    EXPECT_EQ(limit.felt_N_per_mm, 0.5 * limit.stiffness_N_per_mm) << start;
  }
  EXPECT_EQ(limit_at(1e9, 0, 1).kind, StiffnessLimit::Kind::above_all);
  EXPECT_EQ(limit_at(1e9, 0, 1).stiffness_N_per_mm, 200);
  EXPECT_EQ(limit_at(0, 0, 1).kind, StiffnessLimit::Kind::below_all);
  EXPECT_EQ(limit_at(1e9, 1e9, 1).kind, StiffnessLimit::Kind::below_all);
  // Either too soft or not passive at any stiffness.
  EXPECT_EQ(limit_at(1, 1, 5).kind, StiffnessLimit::Kind::below_all);
}

TEST(Passivity, FeltStiffnessOfLineProxyOnAFlatWallMatchesItsSetting) {
  const MillingTool tool;
  const Volume wall = flat_wall(tool);
  HapticSettings settings;
  settings.set_option("stiffness", 1);
  const auto algorithm = make_algorithm(algorithm_named("line-proxy"), settings);
  algorithm->prepare({&wall, tool});
  const WallPressResult result = press_on_wall(*algorithm, tool.burr_radius_mm, device(0.02, 0));
  EXPECT_EQ(result.motion, WallMotion::decays);
  EXPECT_NEAR(result.felt_N_per_mm, 1, 0.02);
}

}  // namespace
}  // namespace osteomill
