#include "osteomill/session/milling_session.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "osteomill/session/milling_setup.h"
#include "osteomill/session/trajectory.h"
#include "osteomill/volume/label_map.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

std::string fault_of(const MillingTool& tool) {
  GridGeometry tooth;
  tooth.dims = {256, 256, 176};
  tooth.spacing_mm = Vec3::Constant(0.125);
  try {
    require_workable(tool, tooth);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(RequireWorkable, ReportsWhyAToolCannotWorkInTheScan) {
  EXPECT_EQ(fault_of({}), "");
  EXPECT_EQ(fault_of({3, 3, 100}), "");
  EXPECT_NE(fault_of({50, 1, 25}).find("the burr's radius, 50 mm, makes it 100 mm wide"), std::string::npos);
  EXPECT_NE(fault_of({1, 20, 25}).find("the shaft's radius, 20 mm"), std::string::npos);
  EXPECT_NE(fault_of({1, 1, 2000}).find("shaft-length must be a number from 0.01 to 1000 mm"),
            std::string::npos);
  EXPECT_NE(fault_of({0.02, 0.02, 25}).find("0.16 of the scan's voxels"), std::string::npos);
  EXPECT_NE(fault_of({-1, 1, 25}), "");
}

// Algorithm that returns scripted results and records its calls.
class ScriptedAlgorithm : public HapticAlgorithm {
 public:
  HapticStep next;
  int resets = 0;
  std::vector<VolumeChange> changes;

  void prepare(const AlgorithmInputs&) override {}
  std::vector<Pose> steps;
  HapticStep step(const Pose& X_WD, double) noexcept override {
    steps.push_back(X_WD);
    next.X_WT = X_WD;
    return next;
  }
  void volume_changed(const VolumeChange& change) noexcept override { changes.push_back(change); }
  void reset() noexcept override { ++resets; }
  int sample_point_count() const override { return 1; }
};

class MillingSessionTest : public ::testing::Test {
 protected:
  MillingSessionTest() {
    Volume bone = testing_support::shape_volume(testing_support::centred_cube(40, 0.25),
                                                testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
    start(std::move(bone));
    device_.put({{0, 0, 1.0}, Quat::Identity()});
  }
  void start(Volume bone, MillingSetup setup = {.guard = GuardSettings::for_simulation()}) {
    setup.algorithm = {.id = {"scripted", "scripted", "#000000"}, .make = [this](auto) {
                         auto algorithm = std::make_unique<ScriptedAlgorithm>();
                         algorithm_ = algorithm.get();
                         return algorithm;
                       }};
    session_ = std::make_unique<MillingSession>(std::make_shared<Volume>(std::move(bone)),
                                                BoneDensities{0, 1000}, setup);
  }
  TickRecord tick(bool spindle_on = true) {
    return session_->tick(device_, {.time_s = time_s_ += 1e-3, .spindle_on = spindle_on});
  }

  ScriptedAlgorithm* algorithm_ = nullptr;
  std::unique_ptr<MillingSession> session_;
  PosedDevice device_;
  double time_s_ = 0;
};

TEST_F(MillingSessionTest, SendsTheRecordedForceToTheDevice) {
  algorithm_->next.wrench = {{0, 0, 3}, {0, 40, 0}};
  const TickRecord record = tick();
  EXPECT_EQ(device_.sent().force_N, Vec3(0, 0, 3));
  EXPECT_EQ(record.wrench.force_N, Vec3(0, 0, 3));
  EXPECT_EQ(record.wrench.torque_Nmm, Vec3(0, 40, 0));
  EXPECT_EQ(record.fault, WrenchFault::none);
}

TEST_F(MillingSessionTest, ClampsAnExcessiveForceAndReportsIt) {
  algorithm_->next.wrench = {{0, 0, 300}, {0, 40, 0}};
  EXPECT_EQ(tick().fault, WrenchFault::force_clamped);
  EXPECT_TRUE(device_.sent().force_N.isApprox(Vec3(0, 0, 20)));
}

// The tool lies on its side, hand to the right, and presses down; bone resists along its surface.
TEST_F(MillingSessionTest, AddsTheCuttingReactionWithinTheForceLimit) {
  start(session_->volume(), {.cutting_reaction = true, .guard = GuardSettings::for_simulation({0.25, 500})});
  const Pose lying{{0, 0, 1.45}, Quat::FromTwoVectors(Vec3::UnitZ(), Vec3::UnitX())};
  device_.put(lying);
  algorithm_->next.X_WT = lying;
  algorithm_->next.burr_force_W_N = {0, 0, -1};
  EXPECT_EQ(tick().wrench.force_N.norm(), 0) << "nothing was cut yet";
  TickRecord record;
  for (int n = 0; n < 50; ++n) record = tick();
  EXPECT_GT(record.removed_mm3, 0.05);
  EXPECT_NEAR(std::abs(record.wrench.force_N.y()), 2.0 / 3.0 * 0.3, 0.01);
  EXPECT_NEAR(record.wrench.force_N.x(), 0, 1e-9);
  EXPECT_GT(record.cutting_torque_W_Nmm.norm(), 0.2);
  EXPECT_TRUE(record.cutting_torque_W_Nmm.isApprox(record.wrench.torque_Nmm)) << "the algorithm gives none";
  algorithm_->next.wrench.force_N = {0, 0, 0.2};
  record = tick();
  EXPECT_EQ(record.fault, WrenchFault::force_clamped);
  EXPECT_LE(record.wrench.force_N.norm(), 0.25 + 1e-12);
  algorithm_->next.wrench = {};
  for (int n = 0; n < 150; ++n) record = tick(false);
  EXPECT_EQ(record.wrench.force_N.norm() + record.wrench.torque_Nmm.norm(), 0) << "the spindle is off";
}

// A restarted burr cuts no more in its first tick than one that never turned.
TEST_F(MillingSessionTest, RestartedSpindleCutsLikeOneThatNeverTurned) {
  device_.put({{0, 0, 1.4}, Quat::Identity()});
  algorithm_->next.burr_force_W_N = {0, 0, -5};
  for (int n = 0; n < 8; ++n) tick();
  for (int n = 0; n < 100; ++n) tick(false);
  const double before_mm3 = session_->removed_mm3();
  const Volume bone = session_->volume();
  const double again_mm3 = tick().removed_mm3 - before_mm3;
  start(bone);
  algorithm_->next.burr_force_W_N = {0, 0, -5};
  EXPECT_EQ(again_mm3, tick().removed_mm3);
}

TEST_F(MillingSessionTest, ResumeStartsTheAlgorithmAtTheOtherSessionsToolPose) {
  session_->resume_from({Pose{{0, 0, 1.5}, Quat::Identity()}, {}});
  tick();
  ASSERT_EQ(algorithm_->steps.size(), 2u);
  EXPECT_EQ(algorithm_->steps[0].position_mm, Vec3(0, 0, 1.5));
  EXPECT_EQ(algorithm_->steps[1].position_mm, Vec3(0, 0, 1.0));
}

// Records calls in order and its simulated time.
class AskedDevice final : public Device {
 public:
  std::string asked;
  double passed_s = 0;
  bool wants_spindle = false;
  Vec3 shown_mm = Vec3::Zero();

  Pose read_pose() override {
    asked += "pose ";
    return {{0, 0, 1.0}, Quat::Identity()};
  }
  void write_wrench(const Wrench&) override { asked += "wrench "; }
  bool is_spindle_requested() const noexcept override { return wants_spindle; }
  void tick_done(const Pose& X_WT, double dt_s) noexcept override {
    asked += "done ";
    shown_mm = X_WT.position_mm;
    passed_s += dt_s;
  }
};

TEST_F(MillingSessionTest, TickReadsThePoseSendsTheWrenchAndReportsDoneInOrder) {
  AskedDevice device;
  algorithm_->next.burr_force_W_N = {0, 0, -5};
  EXPECT_FALSE(session_->tick(device, {}).spindle_on);
  EXPECT_EQ(device.asked, "pose wrench done ");
  EXPECT_EQ(device.shown_mm, Vec3(0, 0, 1.0));
  EXPECT_EQ(device.passed_s, 1e-3);
  device.wants_spindle = true;
  for (int n = 0; n < 20; ++n) EXPECT_TRUE(session_->tick(device, {}).spindle_on);
  EXPECT_GT(session_->removed_mm3(), 0);
  EXPECT_FALSE(session_->tick(device, {.spindle_on = false}).spindle_on);
  EXPECT_FALSE(session_->tick(device, {.paused = true}).spindle_on);

  device.asked.clear();
  device.passed_s = 0;
  EXPECT_EQ(session_->tick(device, {.dt_s = 0.5e-3, .late_s = 2e-3}).dt_s, 2.5e-3);
  EXPECT_EQ(device.asked, "done pose wrench done ") << "missed time passes before the pose is read";
  EXPECT_EQ(device.passed_s, 2.5e-3);
}

TEST_F(MillingSessionTest, PausedTickSendsZeroAndDoesNotStepTheAlgorithm) {
  algorithm_->next.wrench = {{0, 0, 3}, {0, 40, 0}};
  tick(true);
  const TickRecord idle = session_->tick(device_, {.time_s = 1, .spindle_on = true, .paused = true});
  EXPECT_EQ(device_.sent().force_N, Vec3::Zero());
  EXPECT_EQ(idle.wrench.torque_Nmm, Vec3::Zero());
  EXPECT_EQ(idle.X_WT.position_mm, device_.read_pose().position_mm);
  EXPECT_EQ(algorithm_->steps.size(), 1u);
  EXPECT_TRUE(session_->last_change().voxels.empty());
}

TEST_F(MillingSessionTest, ReplacesANonFiniteWrenchByZeroAndResetsTheAlgorithm) {
  algorithm_->next.wrench.torque_Nmm.y() = std::numeric_limits<double>::quiet_NaN();
  algorithm_->next.burr_force_W_N.z() = -5;
  const TickRecord record = tick();
  EXPECT_EQ(record.fault, WrenchFault::not_finite);
  EXPECT_EQ(device_.sent().force_N, Vec3::Zero());
  EXPECT_EQ(device_.sent().torque_Nmm, Vec3::Zero());
  EXPECT_EQ(algorithm_->resets, 1);
  EXPECT_EQ(record.removed_mm3, 0);
  algorithm_->next.wrench.torque_Nmm.setZero();
  EXPECT_EQ(tick().fault, WrenchFault::none);
}

TEST_F(MillingSessionTest, RestartsAtTheLastToolPoseAfterANonFiniteWrench) {
  tick();
  device_.put(Pose{{0, 0, 0.5}, Quat::Identity()});
  algorithm_->next.wrench.force_N.x() = std::numeric_limits<double>::quiet_NaN();
  tick();
  ASSERT_EQ(algorithm_->resets, 1);
  EXPECT_EQ(algorithm_->steps.back().position_mm, Vec3(0, 0, 1.0));
}

TEST_F(MillingSessionTest, ReportsANonFiniteBurrForceAsAFault) {
  algorithm_->next.burr_force_W_N.y() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(tick().fault, WrenchFault::not_finite);
}

TEST_F(MillingSessionTest, SendsZeroForceIfTheDevicePoseIsNotFinite) {
  algorithm_->next.wrench.force_N = {0, 0, 3};
  tick();
  device_.put({{0, std::numeric_limits<double>::quiet_NaN(), 0}, Quat::Identity()});
  const TickRecord record = tick();
  EXPECT_EQ(record.fault, WrenchFault::pose_not_finite);
  EXPECT_EQ(device_.sent().force_N, Vec3::Zero());
  EXPECT_EQ(record.X_WT.position_mm, Vec3(0, 0, 1.0)) << "the tool stays where it was last shown";
}

// Throws once from write_wrench when requested.
class FailingDevice : public Device {
 public:
  PosedDevice posed;
  bool fails_to_write = false;

  Pose read_pose() override { return posed.read_pose(); }
  void write_wrench(const Wrench& wrench) override {
    if (std::exchange(fails_to_write, false)) throw std::runtime_error("lost");
    posed.write_wrench(wrench);
  }
};

TEST_F(MillingSessionTest, SendsZeroAfterAWriteFailureUntilTheToolIsOutOfBone) {
  start(testing_support::shape_volume(testing_support::centred_cube(40, 0.25),
                                      testing_support::plane(Vec3::Zero(), Vec3::UnitZ())),
        {});
  FailingDevice device;
  const auto tick_at = [&](double height_mm, double force_N) {
    device.posed.put({{0, 0, height_mm}, Quat::Identity()});
    algorithm_->next.wrench.force_N = {0, 0, force_N};
    return session_->tick(device, {});
  };
  tick_at(2, 0);
  tick_at(1.45, 3);
  ASSERT_GT(device.posed.sent().force_N.z(), 0);
  device.fails_to_write = true;
  EXPECT_THROW(tick_at(0.9, 3), std::runtime_error);
  EXPECT_EQ(device.posed.sent().force_N, Vec3::Zero());
  for (const double asked_N : {3.0, 0.0}) {
    const TickRecord record = tick_at(0.5, asked_N);
    EXPECT_EQ(record.fault, WrenchFault::held_back) << asked_N;
    EXPECT_EQ(device.posed.sent().force_N, Vec3::Zero());
  }
  EXPECT_EQ(tick_at(2, 0).fault, WrenchFault::none);
  tick_at(1.45, 3);
  EXPECT_GT(device.posed.sent().force_N.z(), 0);
}

TEST_F(MillingSessionTest, ReplacesAnInvalidTickLengthByTheNominalOne) {
  MillingSetup setup{.guard = GuardSettings::for_simulation()};
  setup.vibration.on = setup.contact_transient.on = true;
  start(testing_support::shape_volume(testing_support::centred_cube(40, 0.25),
                                      testing_support::plane(Vec3::Zero(), Vec3::UnitZ())),
        setup);
  algorithm_->next.wrench.force_N = {0, 0, 3};
  algorithm_->next.burr_force_W_N = {0, 0, -3};
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  constexpr double kEver = std::numeric_limits<double>::infinity();
  for (const double length_s : {kNone, kEver, 0.0, -1.0}) {
    const TickRecord record =
        session_->tick(device_, {.dt_s = length_s, .late_s = length_s, .spindle_on = true});
    EXPECT_EQ(record.dt_s, setup.tick_s) << length_s;
  }
  const TickRecord after = tick();
  EXPECT_EQ(after.fault, WrenchFault::none);
  EXPECT_TRUE(after.wrench.force_N.allFinite());
  EXPECT_GT(after.wrench.force_N.z(), 2);
}

TEST_F(MillingSessionTest, RefusesNanOrNegativeGuardSettings) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto refuses = [&](auto set) {
    MillingSetup setup;
    set(setup.guard);
    try {
      start(testing_support::shape_volume(testing_support::centred_cube(8, 1),
                                          testing_support::plane(Vec3::Zero(), Vec3::UnitZ())),
            setup);
    } catch (const std::invalid_argument& refusal) {
      return std::string(refusal.what()).starts_with("guard.");
    }
    return false;
  };
  for (const double value : {kNone, -1.0}) {
    EXPECT_TRUE(refuses([=](GuardSettings& g) { g.limits.force_N = value; })) << value;
    EXPECT_TRUE(refuses([=](GuardSettings& g) { g.limits.torque_Nmm = value; })) << value;
    EXPECT_TRUE(refuses([=](GuardSettings& g) { g.rates.force_N_s = value; })) << value;
    EXPECT_TRUE(refuses([=](GuardSettings& g) { g.rates.torque_Nmm_s = value; })) << value;
    EXPECT_TRUE(refuses([=](GuardSettings& g) { g.blend_s = value; })) << value;
    EXPECT_TRUE(refuses([=](GuardSettings& g) { g.max_move_mm = value; })) << value;
    EXPECT_TRUE(refuses([=](GuardSettings& g) { g.max_turn_rad = value; })) << value;
    EXPECT_TRUE(refuses([=](GuardSettings& g) { g.max_tick_s = value; })) << value;
  }
  EXPECT_FALSE(refuses([](GuardSettings&) {}));
}

TEST_F(MillingSessionTest, RejectsAPoseFartherThanAnyWorkspace) {
  for (const double far_mm : {1e308, -1e308, 1.01 * kMaxPose_mm}) {
    device_.put({{0, far_mm, 0}, Quat::Identity()});
    const TickRecord record = tick();
    EXPECT_EQ(record.fault, WrenchFault::pose_not_finite);
    EXPECT_EQ(device_.sent().force_N, Vec3::Zero());
    EXPECT_TRUE(is_finite(record.X_WT));
  }
  EXPECT_TRUE(algorithm_->steps.empty());
}

TEST_F(MillingSessionTest, CountsNoContactWithALabelWhileTheDeviceHasNoPose) {
  Volume bone = session_->volume();
  const GridGeometry grid = bone.geometry();
  bone.set_labels(std::make_shared<const LabelMap>(std::vector<Label>{{1, "nerve", {}, true}}, grid, grid,
                                                   std::vector<LabelMap::LabelIndex>(grid.voxel_count(), 1)));
  start(std::move(bone));
  device_.put({Vec3::Constant(NAN), Quat::Identity()});
  EXPECT_EQ(tick().label_cuts, LabelCuts{});
  device_.put({{0, 0, 0}, Quat::Identity()});
  EXPECT_EQ(tick().label_cuts.front().label, 1);
}

TEST_F(MillingSessionTest, RemovesBoneOnlyWithTheSpindleOnAndNotifiesTheAlgorithm) {
  algorithm_->next.burr_force_W_N.z() = -2;
  EXPECT_EQ(tick(false).removed_mm3, 0);
  EXPECT_TRUE(algorithm_->changes.empty());
  double removed_mm3 = 0;
  for (int n = 0; n < 100; ++n) removed_mm3 = tick().removed_mm3;
  const double paid_for_mm3 = MillingSettings{}.removal_rate_mm3_per_Ns * 2 * 0.1;
  EXPECT_NEAR(removed_mm3, paid_for_mm3, 0.025 * paid_for_mm3);
  EXPECT_FALSE(algorithm_->changes.empty());
}

}  // namespace
}  // namespace osteomill
