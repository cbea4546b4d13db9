#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "osteomill/session/connection.h"

namespace osteomill {

/// The settings by which a device's handle moves the tool, and the tool's wrench reaches the hand.
struct WorkspaceSettings {
  /// The factor by which the tool moves further than the handle.
  double scale = 1;
  /// The share of the power at the tool that is power at the hand (Workspace::wrench_B).
  double power = 1;
  /// The rotation by which the device stands other than its maker means it to, about the axes of the
  /// operator's view V.
  Vec3 turn_V_deg = Vec3::Zero();
  /// For a device that drives force alone: the distance from the burr of the hand about which the shaft
  /// turns; a torque that turns it becomes a force at the burr. 0: the torque is not felt.
  double shaft_lever_mm = 0;
  friend bool operator==(const WorkspaceSettings&, const WorkspaceSettings&) = default;
};

/// Throws std::invalid_argument naming the setting that is not finite or not positive (the lever: not below
/// 0).
void require_valid(const WorkspaceSettings& settings);

/// Returns how a device stands (turn_V_deg), from two moves of its handle in B that the operator says went to
/// the right and up. Returns nothing if either is shorter than 10 mm, or they are not at a right angle within
/// 30 degrees.
std::optional<Vec3> turn_by_moves_deg(const DeviceCapabilities& device, const Vec3& right_B_mm,
                                      const Vec3& up_B_mm);

/// Returns the view of an operator without a window: at the patient's front, with the head up.
Quat view_from_the_front();

/// Maps poses from a device's base frame B to the scan's W, and wrenches back. The handle's motion since the
/// anchor is turned and scaled, and moves the tool from where it was then; so the handle can be moved on
/// without the tool (a clutch) by anchoring again. All but making it is safe in the haptic tick.
class Workspace {
 public:
  /// Throws std::invalid_argument as `require_valid`.
  Workspace(const DeviceCapabilities& device, const WorkspaceSettings& settings);

  /// Sets valid settings, and the operator's view. The way of moving changes, so anchor again.
  void set(const WorkspaceSettings& settings, const Quat& R_WV);
  /// Lets the handle at `X_BH` hold the tool at `X_WT` from now on.
  void anchor(const Pose& X_WT, const Pose& X_BH) noexcept;
  /// Returns the pose of the tool in W that the handle at `X_BH` holds.
  Pose tool_pose(const Pose& X_BH) const noexcept;

  /// Returns the wrench that the device is to send for one on the tool. By virtual work: whatever small
  /// motion the hand makes, the work done on it is `power` times that done on the tool. With scale s the tool
  /// moves s times as far and turns as much, so the force is power s times the tool's, and the torque power
  /// times. `shaft_W` is the tool's shaft direction. A device that drives force alone gets the torque as its
  /// settings say.
  Wrench wrench_B(const Wrench& wrench_W, const Vec3& shaft_W) const noexcept;

  /// Returns the most that may be asked for at the tool, in W, so that the device can give it; no more than
  /// `limits`. A torque that the device does not drive is limited by `limits` alone.
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

/// Returns the file in which a device's workspace is kept, by the device's name: in `config_folder()`, under
/// devices/; empty if there is no such folder.
std::filesystem::path workspace_path(const std::string& device_name);

/// Returns the settings as they were kept; nothing if none were. Throws InputError naming the file if it is
/// at fault.
std::optional<WorkspaceSettings> read_workspace(const std::filesystem::path& path);
/// Writes the settings. Throws InputError if the file cannot be written.
void save_workspace(const std::filesystem::path& path, const WorkspaceSettings& settings);

}  // namespace osteomill
