#include "app/device_option.h"

#include <utility>

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <fmt/core.h>

#include "osteomill/base/input_error.h"
#include "osteomill/session/hardware.h"
#include "osteomill/session/space_mouse.h"
#include "osteomill/session/workspace.h"

#include "app/option_checks.h"
#include "app/progress.h"

namespace osteomill::app {

namespace {

std::string name_in(const std::string& device) {
  return device.substr(0, device.find(':'));
}

std::string address_in(const std::string& device) {
  const std::size_t colon = device.find(':');
  return colon == std::string::npos ? "" : device.substr(colon + 1);
}

std::vector<std::string> device_names() {
  std::vector<std::string> names{kMouse, kSpaceMouse, kSimulated};
  for (const HardwareKind& kind : hardware_kinds()) names.emplace_back(kind.name);
  return names;
}

CLI::Validator known_device() {
  CLI::Validator check(
      [](std::string& text) -> std::string {
        const std::string name = name_in(text);
        const HardwareKind* kind = hardware_named(name);
        const bool has_address = name != text;
        if (kind != nullptr) return has_address && kind->address.empty() ? name + " takes no address" : "";
        for (const std::string& known : device_names()) {
          if (known == name) return has_address ? name + " takes no address" : "";
        }
        const std::string near = did_you_mean(name, device_names());
        return "there is no device " + name + (near.empty() ? "; osteomill devices lists them" : near);
      },
      "");
  return with_choices(std::move(check), device_names());
}

// Options on the command line take precedence over stored ones.
WorkspaceSettings workspace_of(const DeviceOption& option, const std::string& device_name) {
  const auto path = workspace_path(device_name);
  const auto kept = read_workspace(path);
  WorkspaceSettings settings = kept.value_or(WorkspaceSettings{});
  settings.scale = option.scale.value_or(settings.scale);
  settings.power = option.power.value_or(settings.power);
  settings.shaft_lever_mm = option.shaft_lever_mm.value_or(settings.shaft_lever_mm);
  if (option.turn_deg.size() == 3)
    settings.turn_V_deg = {option.turn_deg[0], option.turn_deg[1], option.turn_deg[2]};
  require_valid(settings);
  if (settings != kept.value_or(WorkspaceSettings{}) && !path.empty()) save_workspace(path, settings);
  return settings;
}

std::string degrees_of_freedom(const DeviceCapabilities& device) {
  return fmt::format("{} degrees of freedom sensed, {} driven, up to {:g} N", device.sensed, device.driven,
                     device.limits.force_N) +
         (device.driven == 6 ? fmt::format(" and {:g} N mm", device.limits.torque_Nmm) : "") +
         (device.watchdog_s > 0
              ? fmt::format(", drops the force {:.0f} ms after the last wrench", 1e3 * device.watchdog_s)
              : ", no known watchdog");
}

}  // namespace

void add_device_option(CLI::App& command, DeviceOption& option) {
  command.option_defaults()->group("The device");
  command
      .add_option("--device", option.device,
                  "Device that holds the tool, NAME or NAME:ADDRESS; osteomill devices lists them")
      ->check(known_device())
      ->type_name("DEVICE")
      ->capture_default_str();
  add_positive(command, "--device-scale", option.scale, "NUMBER",
               "Tool motion per handle motion, mm/mm (default: as last used with this device, at first 1)");
  add_positive(command, "--device-power", option.power, "NUMBER",
               "Ratio of the power at the hand to the power at the tool (default: as last used with this "
               "device, at first 1)");
  command
      .add_option("--device-turn", option.turn_deg,
                  "Rotation of the device's base, as a rotation vector in degrees about the axes right, up "
                  "and towards you (default: as last used with this device, at first 0,0,0)")
      ->delimiter(',')
      ->expected(3)
      ->type_name("X,Y,Z");
  command
      .add_option(
          "--shaft-lever", option.shaft_lever_mm,
          "Distance from the hand to the burr, by which a device without torque output renders the torque as "
          "a force; 0 renders no torque (default: as last used with this device, at first 0)")
      ->check(number_of(NumberRange::not_negative()))
      ->type_name("mm");
}

void add_send_options(CLI::App& command, SendOption& option) {
  command
      .add_option(
          "--send-bone", option.address,
          "Send the bone while it is milled, and the tool, over OpenIGTLink, for example to 3D Slicer")
      ->type_name("HOST:PORT");
  add_positive(command, "--send-rate", option.tool_rate_Hz, "Hz",
               "Rate at which --send-bone sends the tool's pose and the readings");
}

std::unique_ptr<BoneSender> send_bone(const BoneFollower& bone, const SendOption& option) {
  if (option.address.empty()) return nullptr;
  return std::make_unique<BoneSender>(bone, option.address, option.tool_rate_Hz);
}

std::unique_ptr<ConnectedDevice> open_device(const DeviceOption& option) {
  const HardwareKind* kind = hardware_named(name_in(option.device));
  if (option.is_device(kSpaceMouse) && !SpaceMouse().is_present())
    throw InputError("--device spacemouse", kNoSpaceMouse);
  if (kind == nullptr) return nullptr;
  const auto open = [kind, address = address_in(option.device)] { return kind->open(address); };
  auto device = std::make_unique<ConnectedDevice>(open);
  device->set_workspace(workspace_of(option, device->capabilities().name));
  device->start();
  print_error(fmt::format("osteomill: {}: {}\n", in_one_line(device->capabilities().name),
                          degrees_of_freedom(device->capabilities())));
  return device;
}

void describe_device(RunDescription& run, const std::string& hand, const ConnectedDevice* device) {
  if (device == nullptr) {
    run.settings.push_back({"device", hand, ""});
    return;
  }
  const DeviceCapabilities& can = device->capabilities();
  const WorkspaceSettings& workspace = device->workspace();
  run.settings.push_back({"device", can.name, ""});
  run.settings.push_back({"device.sensed", static_cast<double>(can.sensed), ""});
  run.settings.push_back({"device.driven", static_cast<double>(can.driven), ""});
  run.settings.push_back({"device.scale", workspace.scale, ""});
  run.settings.push_back({"device.power", workspace.power, ""});
  const char* const axes[] = {"right", "up", "towards"};
  for (Eigen::Index n = 0; n < 3; ++n)
    run.settings.push_back({fmt::format("device.turn_{}", axes[n]), workspace.turn_V_deg[n], "deg"});
  run.settings.push_back({"device.shaft_lever", workspace.shaft_lever_mm, "mm"});
}

}  // namespace osteomill::app
