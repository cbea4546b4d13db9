#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "osteomill/device/connected_device.h"
#include "osteomill/recording/run_description.h"

namespace osteomill::app {

/// Hands that need no haptic hardware.
inline constexpr const char* kMouse = "mouse";
inline constexpr const char* kSpaceMouse = "spacemouse";
inline constexpr const char* kSimulated = "simulated";
inline constexpr const char* kNoSpaceMouse = "the daemon spacenavd does not answer";

/// Which device, and how it moves the tool where that is not as it was kept.
struct DeviceOption {
  /// NAME or NAME:ADDRESS.
  std::string device;
  std::optional<double> scale;
  std::optional<double> power;
  std::vector<double> turn_deg;
  std::optional<double> shaft_lever_mm;

  bool is(const char* name) const { return device == name; }
};

/// Adds --device, which is `option.device` where it is not given, and how its workspace lies.
void add_device_option(CLI::App& command, DeviceOption& option);

/// Where bone and tool go as it is milled (BoneSender), nowhere where that is empty.
struct SendOption {
  std::string address;
  double tool_rate_Hz = 30;
};

/// Adds --send-bone and --send-rate.
void add_send_options(CLI::App& command, SendOption& option);

/// The haptic hardware that was asked for, its workspace as it was kept for it by its name, with what was
/// given of it now, which is kept as well; says on standard error which device that is. Null for a hand
/// without hardware. Throws InputError where the device, or what tells of a SpaceMouse, cannot be had.
std::unique_ptr<ConnectedDevice> open_device(const DeviceOption& option);

/// What a recording says of who held the tool.
void describe_device(RunDescription& run, const std::string& hand, const ConnectedDevice* device);

}  // namespace osteomill::app
