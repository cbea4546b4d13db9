#include <string>
#include <string_view>

#include "app/commands.h"
#include "app/device_option.h"
#include <fmt/core.h>

#include "osteomill/device/hardware.h"
#include "osteomill/device/space_mouse.h"

namespace osteomill::app {

namespace {

void print_device(std::string_view name, std::string_view meaning, const FoundDevice& found) {
  fmt::print("{}\n    {}\n    {}: {}\n", name, meaning, found.there ? "found" : "not found", found.text);
}

void list_devices() {
  for (const HardwareKind& kind : hardware_kinds()) {
    const std::string address = kind.address.empty() ? "" : fmt::format("[:{}]", kind.address);
    print_device(std::string(kind.name) + address, kind.meaning, kind.find(""));
  }
  print_device(kMouse, "a virtual hand that mouse and keyboard move", {true, "in the window of simulate"});
  const bool space_mouse = SpaceMouse().present();
  print_device(kSpaceMouse, "the same, moved by a SpaceMouse",
               {space_mouse, space_mouse ? "spacenavd answers" : kNoSpaceMouse});
  print_device(kSimulated, "a simulated operator who mills by itself", {true, "always"});
}

}  // namespace

void add_devices_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "devices", "List the devices that can hold the tool: what is found, and why not");
  command->group("Reference");
  command->callback(list_devices);
}

}  // namespace osteomill::app
