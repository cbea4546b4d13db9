#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "osteomill/openigtlink/bone_sender.h"
#include "osteomill/recording/run_description.h"
#include "osteomill/session/connected_device.h"

namespace osteomill::app {

/// Devices that need no haptic hardware.
inline constexpr const char* kMouse = "mouse";
inline constexpr const char* kSpaceMouse = "spacemouse";
inline constexpr const char* kSimulated = "simulated";
inline constexpr const char* kNoSpaceMouse = "the daemon spacenavd does not answer";

/// The device that holds the tool, and workspace settings that replace those stored for it.
struct DeviceOption {
  /// NAME or NAME:ADDRESS.
  std::string device;
  std::optional<double> scale;
  std::optional<double> power;
  std::vector<double> turn_deg;
  std::optional<double> shaft_lever_mm;

  bool is_device(const char* name) const { return device == name; }
};

/// Adds --device, with the default `option.device`, and the options of the workspace.
void add_device_option(CLI::App& command, DeviceOption& option);

/// The receiver of the bone and the tool during milling (BoneSender).
struct SendOption {
  /// HOST:PORT; empty to send nothing.
  std::string address;
  double tool_rate_Hz = 30;
};

/// Adds --send-bone and --send-rate.
void add_send_options(CLI::App& command, SendOption& option);

/// Makes the sender; null if the address is empty. Throws as BoneSender does.
std::unique_ptr<BoneSender> send_bone(const BoneFollower& bone, const SendOption& option);

/// Opens the requested haptic hardware and prints its name on standard error; null for a device without
/// hardware. Its workspace is the one stored under the device's name, changed by the given options and stored
/// again. Throws InputError if the device, or the daemon that a SpaceMouse needs, is missing.
std::unique_ptr<ConnectedDevice> open_device(const DeviceOption& option);

/// Writes the device that held the tool, or `hand` if `device` is null, into a recording's description.
void describe_device(RunDescription& run, const std::string& hand, const ConnectedDevice* device);

}  // namespace osteomill::app
