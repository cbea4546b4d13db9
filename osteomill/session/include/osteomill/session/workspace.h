#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "osteomill/session/connection.h"

namespace osteomill {

/// Settings of the mapping from a device's handle to the tool, and from the tool's wrench to the hand.
struct WorkspaceSettings {
  /// Tool displacement per handle displacement.
  double scale = 1;
  /// Ratio of the power at the hand to that at the tool (Workspace::wrench_B).
  double power = 1;
  /// Rotation of the device from the placement that its vendor intends, as a rotation vector in the
  /// operator's view V, degrees.
  Vec3 turn_V_deg = Vec3::Zero();
  /// For a device that drives only force: distance from the burr to the hand, about which the shaft rotates;
  /// a torque on the shaft is rendered as a force at the burr. 0: the torque is not felt.
  double shaft_lever_mm = 0;
  friend bool operator==(const WorkspaceSettings&, const WorkspaceSettings&) = default;
};

/// Throws std::invalid_argument, naming the setting, if one is not finite or not positive (the lever may be
/// 0).
void require_valid(const WorkspaceSettings& settings);

/// Returns the placement of a device (turn_V_deg) from two handle displacements in B that the operator made
/// to the right and up. Returns nothing if either is shorter than 10 mm or the angle between them differs
/// from 90 degrees by more than 30.
std::optional<Vec3> turn_by_moves_deg(const DeviceCapabilities& device, const Vec3& right_B_mm,
                                      const Vec3& up_B_mm);

/// Returns the rotation R_WV of the default view: from the patient's front, head up.
Quat view_from_the_front();

/// Maps poses from a device's base frame B to the scan's W, and wrenches back. The handle's motion since the
/// anchor is rotated, scaled and applied to the tool's pose at the anchor. Anchoring again after the handle
/// has moved without the tool implements a clutch. All functions except the constructor are safe in the
/// haptic tick.
class Workspace {
 public:
  /// Throws std::invalid_argument as `require_valid`.
  Workspace(const DeviceCapabilities& device, const WorkspaceSettings& settings);

  /// Sets the settings, which must be valid, and the operator's view. Anchor again afterwards, because the
  /// mapping changes.
  void set(const WorkspaceSettings& settings, const Quat& R_WV);
  /// From now on, the handle at `X_BH` corresponds to the tool at `X_WT`.
  void anchor(const Pose& X_WT, const Pose& X_BH) noexcept;
  /// Returns the tool pose in W for the handle at `X_BH`.
  Pose tool_pose(const Pose& X_BH) const noexcept;

  /// Returns the device wrench for a wrench on the tool, by virtual work: for any small motion the work on
  /// the hand is `power` times that on the tool. With scale s the tool moves s times as far and rotates by
  /// the same angle, so the force is scaled by power * s and the torque by power. `shaft_W` is the tool's
  /// shaft direction. For a device that drives only force, the torque is rendered as `shaft_lever_mm`
  /// specifies.
  Wrench wrench_B(const Wrench& wrench_W, const Vec3& shaft_W) const noexcept;

  /// Returns `limits`, reduced so that the device can give any wrench within them, at the tool in W. A torque
  /// that the device does not drive is limited only by `limits`.
  WrenchLimits limits_W(const WrenchLimits& limits) const;

 private:
  WorkspaceSettings settings_;
  bool drives_torque_;
  WrenchLimits device_limits_;
  Quat R_VB_as_made_;
  Quat R_WB_;
  Pose anchor_X_WT_;
  Pose anchor_X_BH_;
};

/// Returns the file that stores a device's workspace, by the device's name: in devices/ of `config_folder()`;
/// empty if there is no such folder.
std::filesystem::path workspace_path(const std::string& device_name);

/// Returns the stored settings, or nothing if the file does not exist. Throws InputError with the file name
/// if the file is invalid.
std::optional<WorkspaceSettings> read_workspace(const std::filesystem::path& path);
/// Writes the settings. Throws InputError if the file cannot be written.
void save_workspace(const std::filesystem::path& path, const WorkspaceSettings& settings);

}  // namespace osteomill
