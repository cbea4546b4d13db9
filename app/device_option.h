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

/// Hands that need no haptic hardware.
inline constexpr const char* kMouse = "mouse";
inline constexpr const char* kSpaceMouse = "spacemouse";
inline constexpr const char* kSimulated = "simulated";
inline constexpr const char* kNoSpaceMouse = "the daemon spacenavd does not answer";

/// The device that holds the tool, and the settings of its workspace that replace those kept for it.
struct DeviceOption {
  /// NAME or NAME:ADDRESS.
  std::string device;
  std::optional<double> scale;
  std::optional<double> power;
  std::vector<double> turn_deg;
  std::optional<double> shaft_lever_mm;

  bool is_device(const char* name) const { return device == name; }
};

/// Adds --device, whose default is `option.device`, and the options of its workspace.
void add_device_option(CLI::App& command, DeviceOption& option);

/// The program to which the bone and the tool are sent while it is milled (BoneSender).
struct SendOption {
  /// HOST:PORT; empty to send nothing.
  std::string address;
  double tool_rate_Hz = 30;
};

/// Adds --send-bone and --send-rate.
void add_send_options(CLI::App& command, SendOption& option);

/// Makes the sender; null if nothing is to be sent. Throws as BoneSender does.
std::unique_ptr<BoneSender> send_bone(const BoneFollower& bone, const SendOption& option);

/// Opens the haptic hardware that was asked for and names it on standard error; null for a hand without
/// hardware. Its workspace is the one kept under the device's name, changed by what the option gives, and
/// that is then kept. Throws InputError if the device, or the daemon that a SpaceMouse needs, is not there.
std::unique_ptr<ConnectedDevice> open_device(const DeviceOption& option);

/// Writes into a recording's description which hand and device held the tool.
void describe_device(RunDescription& run, const std::string& hand, const ConnectedDevice* device);

}  // namespace osteomill::app
