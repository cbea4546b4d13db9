#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "osteomill/session/milling_session.h"
#include "osteomill/session/milling_setup.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

// Keeps the tool at the device and reports a fixed burr force.
class PressingAlgorithm : public HapticAlgorithm {
 public:
  HapticStep next;

  void prepare(const AlgorithmInputs&) override {}
  HapticStep step(const Pose& X_WD, double) noexcept override {
    next.X_WT = X_WD;
    return next;
  }
  void volume_changed(const VolumeChange&) noexcept override {}
  void reset() noexcept override {}
  int sample_point_count() const override { return 1; }
};

// The tool lies on its side on bone that fills the lower half of the grid; the burr's equator presses down.
class CuttingSession : public ::testing::Test {
 protected:
  void start(MillingSetup setup) {
    setup.guard = GuardSettings::for_simulation({50, 5000});
    setup.algorithm = {.id = {"pressing", "pressing", "#000000"}, .make = [this](auto) {
                         auto algorithm = std::make_unique<PressingAlgorithm>();
                         algorithm_ = algorithm.get();
                         return algorithm;
                       }};
    Volume bone = testing_support::shape_volume(testing_support::centred_cube(56, 0.25),
                                                testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
    session_ = std::make_unique<MillingSession>(std::make_shared<Volume>(std::move(bone)),
                                                BoneDensities{0, 1000}, setup);
    device_.put(at(1.45));
  }
  static Pose at(double z_mm, double y_mm = 0) {
    return {{0, y_mm, z_mm}, Quat::FromTwoVectors(Vec3::UnitZ(), Vec3::UnitX())};
  }
  void press(double force_N) {
    algorithm_->next.burr_force_W_N = {0, 0, -force_N};
    algorithm_->next.wrench.force_N = {0, 0, force_N};
  }
  TickRecord ticks(int count, bool spindle_on = true) {
    TickRecord record;
    for (int n = 0; n < count; ++n)
      record = session_->tick(device_, {.time_s = time_s_ += 1e-3, .spindle_on = spindle_on});
    return record;
  }

  PressingAlgorithm* algorithm_ = nullptr;
  std::unique_ptr<MillingSession> session_;
  PosedDevice device_;
  double time_s_ = 0;
};

constexpr double kEquator = 0.75, kFriction = 0.4, kBurrRadius_mm = 1.5;

TEST_F(CuttingSession, PushSlowsTheSpindleAlongItsTorqueSpeedLine) {
  start({.law = CuttingLaw::chips, .handpiece = Handpiece::surgical});
  EXPECT_NEAR(ticks(1000).spindle_rpm, 40000, 400);
  press(4);
  const double load = kFriction * 4 * kEquator * kBurrRadius_mm / 8.1;
  const TickRecord record = ticks(1000);
  EXPECT_NEAR(record.spindle_rpm, 40000 * (1 - load), 0.02 * 40000);
  EXPECT_LT(ticks(2000, false).spindle_rpm, 1);
}

TEST_F(CuttingSession, StallStopsRemovalButKeepsTheContactForce) {
  start({.law = CuttingLaw::chips, .handpiece = Handpiece::surgical});
  ticks(1000);
  press(25);
  const TickRecord stalled = ticks(2000);
  EXPECT_EQ(stalled.spindle_rpm, 0);
  EXPECT_GT(stalled.removed_mm3, 0);
  // Fresh bone under the burr stays while the spindle is stalled, and is cut once the push lets it turn.
  device_.put(at(1.1));
  const TickRecord later = ticks(500);
  EXPECT_EQ(later.removed_mm3, stalled.removed_mm3);
  EXPECT_EQ(later.cutting_power_W, 0);
  EXPECT_EQ(later.wrench.force_N, Vec3(0, 0, 25));
  press(1);
  EXPECT_GT(ticks(500).removed_mm3, later.removed_mm3 + 0.01);
}

TEST_F(CuttingSession, ConstantEnergyRemovesLessDuringRunUp) {
  start({.handpiece = Handpiece::surgical});
  press(1);
  device_.put(at(1.2));
  const TickRecord run_up = ticks(20);
  start({});
  press(1);
  device_.put(at(1.2));
  EXPECT_LT(run_up.removed_mm3, 0.2 * ticks(20).removed_mm3);
}

TEST_F(CuttingSession, DragsByFrictionWhenPressingWithoutRemoval) {
  start({.law = CuttingLaw::chips, .drag = true});
  device_.put(at(5));
  press(2);
  const TickRecord record = ticks(200);
  EXPECT_EQ(record.removed_mm3, 0);
  EXPECT_NEAR(std::abs(record.wrench.force_N.y()), 2.0 / 3.0 * kFriction * 2, 1e-6);
  EXPECT_LE(record.wrench.force_N.head<2>().norm(), kFriction * 2);
  start({.law = CuttingLaw::chips, .cutting_reaction = true});
  device_.put(at(5));
  press(2);
  EXPECT_EQ(ticks(200).wrench.force_N, Vec3(0, 0, 2));
}

TEST_F(CuttingSession, StalledBurrTorqueIsLimitedToTheStallTorque) {
  start({.law = CuttingLaw::chips, .handpiece = Handpiece::turbine, .drag = true});
  device_.put(at(5));
  press(20);
  const TickRecord record = ticks(2000);
  EXPECT_EQ(record.spindle_rpm, 0);
  EXPECT_LE(std::abs(record.wrench.torque_Nmm.x()), 2.33 * 1.001);
  EXPECT_GT(std::abs(record.wrench.torque_Nmm.x()), 2.2);
}

// The spindle supplies the energy of drag: along any path the hand gets at most the friction force times the
// path length.
TEST_F(CuttingSession, DragEnergyIsBoundedByFrictionTimesPathLength) {
  start({.law = CuttingLaw::chips, .drag = true});
  press(2);
  algorithm_->next.wrench = {};
  double way_mm = 0, before_mm = 0;
  for (int n = 0; n < 2000; ++n) {
    const double y_mm = 2 * std::sin(0.01 * n) + 0.5 * std::sin(0.037 * n);
    way_mm += std::abs(y_mm - before_mm);
    before_mm = y_mm;
    device_.put(at(5, y_mm));
    EXPECT_LE(std::abs(ticks(1).energy_given_Nmm), kFriction * 2 * way_mm + 1e-9);
  }
}

TEST_F(CuttingSession, VibrationStopsWhenNothingIsCut) {
  start({.law = CuttingLaw::chips, .vibration = {.on = true}});
  press(2);
  algorithm_->next.wrench = {};
  EXPECT_GT(ticks(50).wrench.force_N.norm(), 0.05);
  device_.put(at(5));
  EXPECT_LT(ticks(200).wrench.force_N.norm(), 1e-6);
}

TEST(ShaftDrag, ForceOpposesShaftRotationAtTheContact) {
  const Pose upright{{1, 2, 3}, Quat::Identity()};
  // Bone at +x, 10 mm above the burr, pushes the shaft with 2 N.
  const ShaftDrag drag = shaft_drag({}, upright, {{-2, 0, 0}, {0, -20, 0}});
  EXPECT_TRUE(drag.wrench.force_N.isApprox(Vec3(0, 2 * kShaftFriction, 0)));
  EXPECT_TRUE(drag.wrench.torque_Nmm.isApprox(Vec3(1, 0, 10).cross(drag.wrench.force_N)));
  EXPECT_NEAR(drag.torque_Nmm, 2 * kShaftFriction, 1e-12);
  EXPECT_EQ(shaft_drag({}, upright, {{0, 0, 5}, {}}).torque_Nmm, 0);
}

}  // namespace
}  // namespace osteomill
