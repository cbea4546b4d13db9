#include "osteomill/session/workspace.h"

#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"

namespace osteomill {
namespace {

const Pose kToolStart{{10, -20, 30}, quaternion_from_rotation_vector({0.3, -0.2, 0.5})};
const Pose kHandleStart{{1, 2, 3}, quaternion_from_rotation_vector({-0.1, 0.4, 0.2})};
const Quat kView = quaternion_from_rotation_vector({0.7, 0.1, -0.4});

DeviceCapabilities device(int driven) {
  DeviceCapabilities can;
  can.driven = driven;
  can.limits = {6, 100};
  can.R_VB = quaternion_from_rotation_vector({0, 1.5, 0.2});
  return can;
}

Workspace anchored(int driven, const WorkspaceSettings& settings) {
  Workspace workspace(device(driven), settings);
  workspace.set(settings, kView);
  workspace.anchor(kToolStart, kHandleStart);
  return workspace;
}

// Compares the work of small hand motions at the hand and at the tool.
TEST(Workspace, HandPowerIsToolPowerTimesThePowerSetting) {
  const WorkspaceSettings settings{0.4, 1.7, {10, 20, -30}};
  const Workspace workspace = anchored(6, settings);
  const Wrench wrench_W{{1, -2, 0.5}, {30, 10, -20}};
  const Pose X_WT = workspace.tool_pose(kHandleStart);
  const Wrench wrench_B = workspace.wrench_B(wrench_W, shaft_direction(X_WT));
  constexpr double kSmall = 1e-6;
  for (const auto& [move, turn] : {std::pair{Vec3(1, 0, 0), Vec3(0, 0, 0)},
                                   {Vec3(0, 2, -1), Vec3(0, 0, 0)},
                                   {Vec3(0, 0, 0), Vec3(1, -1, 2)},
                                   {Vec3(3, 1, 1), Vec3(-1, 0, 1)}}) {
    const Vec3 move_B_mm = kSmall * move;
    const Vec3 turn_B_rad = kSmall * turn;
    const Pose moved{kHandleStart.position_mm + move_B_mm,
                     quaternion_from_rotation_vector(turn_B_rad) * kHandleStart.orientation};
    const Pose X_WT_moved = workspace.tool_pose(moved);
    const double work_on_tool =
        wrench_W.force_N.dot(X_WT_moved.position_mm - X_WT.position_mm) +
        wrench_W.torque_Nmm.dot(rotation_vector(X_WT_moved.orientation * X_WT.orientation.conjugate()));
    const double work_on_hand = wrench_B.force_N.dot(move_B_mm) + wrench_B.torque_Nmm.dot(turn_B_rad);
    EXPECT_NEAR(work_on_hand, settings.power * work_on_tool, 1e-4 * std::abs(work_on_tool));
  }
}

TEST(Workspace, AnchorKeepsTheToolPoseAndLaterHandMotionMovesIt) {
  Workspace workspace = anchored(6, {2});
  EXPECT_NEAR((workspace.tool_pose(kHandleStart).position_mm - kToolStart.position_mm).norm(), 0, 1e-12);
  const Pose elsewhere{{-7, 5, 9}, quaternion_from_rotation_vector({0.9, 0.2, 0.1})};
  workspace.anchor(kToolStart, elsewhere);
  Pose right = elsewhere;
  // To the operator's right, for the device's placement.
  right.position_mm += device(6).R_VB.conjugate() * Vec3(3, 0, 0);
  const Pose moved = workspace.tool_pose(right);
  EXPECT_NEAR((moved.position_mm - (kToolStart.position_mm + kView * Vec3(6, 0, 0))).norm(), 0, 1e-12);
  EXPECT_NEAR(moved.orientation.angularDistance(kToolStart.orientation), 0, 1e-7);
}

TEST(Workspace, DefaultViewIsFromThePatientsFrontWithTheHeadUp) {
  DeviceCapabilities can;
  Workspace workspace(can, {});
  workspace.anchor({}, {});
  EXPECT_NEAR((workspace.tool_pose({{0, 1, 0}, Quat::Identity()}).position_mm - Vec3(0, 0, 1)).norm(), 0,
              1e-12);
  EXPECT_NEAR((workspace.tool_pose({{0, 0, 1}, Quat::Identity()}).position_mm - Vec3(0, -1, 0)).norm(), 0,
              1e-12);
}

// A rotated device, and hand motions that are not quite perpendicular.
TEST(Workspace, ComputesDevicePlacementFromTwoMovesAndRefusesBadMoves) {
  const DeviceCapabilities can = device(6);
  const Vec3 turned_deg(20, -110, 45);
  const Quat R_VB = quaternion_from_rotation_vector(std::numbers::pi / 180 * turned_deg) * can.R_VB;
  const auto turn_V_deg =
      turn_by_moves_deg(can, R_VB.conjugate() * Vec3(40, 0, 0), R_VB.conjugate() * Vec3(5, 30, 0));
  ASSERT_TRUE(turn_V_deg);
  EXPECT_NEAR((*turn_V_deg - turned_deg).norm(), 0, 1e-6);
  EXPECT_FALSE(turn_by_moves_deg(can, Vec3(9, 0, 0), Vec3(0, 30, 0)));
  EXPECT_FALSE(turn_by_moves_deg(can, Vec3(30, 0, 0), Vec3(30, 20, 0)));
  EXPECT_FALSE(turn_by_moves_deg(can, Vec3(30, 0, 0), Vec3(0, std::numeric_limits<double>::quiet_NaN(), 0)));
}

TEST(Workspace, CapsLimitsAtTheDeviceLimitsMappedToTheTool) {
  const WrenchLimits session{20, 500};
  EXPECT_DOUBLE_EQ(anchored(6, {0.5, 2}).limits_W(session).force_N, 6);
  EXPECT_DOUBLE_EQ(anchored(6, {0.5, 2}).limits_W(session).torque_Nmm, 50);
  EXPECT_DOUBLE_EQ(anchored(6, {0.1, 1}).limits_W(session).force_N, 20);
  // A torque that is not driven is not limited by the device.
  EXPECT_DOUBLE_EQ(anchored(3, {1, 2}).limits_W(session).torque_Nmm, 500);
}

TEST(Workspace, ForceOnlyDeviceRendersTorqueAsForceOnlyWithAShaftLever) {
  const Vec3 shaft_W(0, 0, 1);
  // Bone 10 mm up the shaft pushes it to the right with 2 N.
  const Wrench leaning{{2, 0, 0}, Vec3(0, 0, 10).cross(Vec3(2, 0, 0))};
  const Wrench plain = anchored(3, {}).wrench_B(leaning, shaft_W);
  EXPECT_EQ(plain.torque_Nmm, Vec3::Zero());
  EXPECT_NEAR(plain.force_N.norm(), 2, 1e-12);
  // With the hand at 40 mm, the equivalent force at the burr is a quarter smaller.
  WorkspaceSettings settings;
  settings.shaft_lever_mm = 40;
  const Wrench levered = anchored(3, settings).wrench_B(leaning, shaft_W);
  EXPECT_EQ(levered.torque_Nmm, Vec3::Zero());
  EXPECT_NEAR(levered.force_N.norm(), 1.5, 1e-12);
  EXPECT_NEAR((levered.force_N - 0.75 * plain.force_N).norm(), 0, 1e-12);
  EXPECT_NEAR((anchored(6, settings).wrench_B(leaning, shaft_W).force_N - plain.force_N).norm(), 0, 1e-12);
}

TEST(Workspace, SettingsOutOfRangeAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const WorkspaceSettings& wrong :
       {WorkspaceSettings{0}, WorkspaceSettings{nan}, WorkspaceSettings{1, -1},
        WorkspaceSettings{1, 1, {nan, 0, 0}}, WorkspaceSettings{1, 1, Vec3::Zero(), -1}}) {
    EXPECT_THROW(Workspace(device(6), wrong), std::invalid_argument);
  }
}

class WorkspaceFile : public ::testing::Test {
 protected:
  void SetUp() override { setenv("XDG_CONFIG_HOME", (::testing::TempDir() + "/config").c_str(), 1); }
  void TearDown() override {
    std::filesystem::remove_all(::testing::TempDir() + "/config");
    unsetenv("XDG_CONFIG_HOME");
  }
};

TEST_F(WorkspaceFile, StoresSettingsPerDeviceName) {
  const std::string name = "Lab/stylus\n";
  const std::filesystem::path path = workspace_path(name);
  EXPECT_EQ(path.filename(), "Lab-stylus-.toml");
  EXPECT_FALSE(read_workspace(path));
  const WorkspaceSettings kept{0.25, 4, {0, 90, 0.1}, 30};
  save_workspace(path, kept);
  EXPECT_EQ(read_workspace(path), kept);
  EXPECT_FALSE(read_workspace(workspace_path("another")));
}

TEST_F(WorkspaceFile, ReportsTheFileOfInvalidSettings) {
  const std::filesystem::path path = workspace_path("lab");
  save_workspace(path, {});
  for (const char* text :
       {"scale = -1\n", "scale = \"large\"\n", "turn_deg = [1, 2]\n", "size = 3\n", "scale ="}) {
    std::ofstream(path) << text;
    try {
      read_workspace(path);
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find(path.string() + ": "), 0u) << error.what();
    }
  }
}

}  // namespace
}  // namespace osteomill
