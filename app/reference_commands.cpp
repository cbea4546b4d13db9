#include <cmath>
#include <string>
#include <string_view>

#include <fmt/core.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/session/hardware.h"
#include "osteomill/session/space_mouse.h"

#include "app/commands.h"
#include "app/device_option.h"

namespace osteomill::app {

namespace {

void print_device(std::string_view name, std::string_view meaning, const FoundDevice& found) {
  fmt::print("{}\n    {}\n    {}: {}\n", name, meaning, found.is_present ? "found" : "not found", found.text);
}

void list_devices() {
  for (const HardwareKind& kind : hardware_kinds()) {
    const std::string address = kind.address.empty() ? "" : fmt::format("[:{}]", kind.address);
    print_device(std::string(kind.name) + address, kind.meaning, kind.find(""));
  }
  print_device(kMouse, "a virtual hand moved by mouse and keyboard", {true, "in the window of simulate"});
  const bool space_mouse = SpaceMouse().is_present();
  print_device(kSpaceMouse, "a virtual hand moved by a SpaceMouse",
               {space_mouse, space_mouse ? "spacenavd answers" : kNoSpaceMouse});
  print_device(kSimulated, "a simulated operator that mills by itself", {true, "always"});
}

void print_settings(const AlgorithmDescription& algorithm) {
  fmt::print("\n## {}\n{}.\n\n| setting | unit | range | default | meaning |\n|---|---|---|---|---|\n",
             algorithm.id.label, algorithm.summary);
  for (const SettingDescription& setting : algorithm.settings) {
    const std::string option = setting.option.empty() ? "" : fmt::format(" (also `--{}`)", setting.option);
    fmt::print("| `{}` | {} | {} | {:g} | {}{} |\n", setting.name, setting.unit, range_text(setting.range),
               setting.value, setting.doc, option);
  }
}

}  // namespace

void add_devices_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "devices", "List the devices that can hold the tool, and whether each was found");
  command->group("Reference");
  command->callback(list_devices);
}

void add_settings_command(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("settings", "List every setting of every algorithm, as a Markdown table");
  command->group("Reference");
  command->callback([] {
    fmt::print(
        "# Settings of the algorithms\n\n"
        "Written by `osteomill settings`; a test compares this page with it. Set one with `--set "
        "ALGORITHM.SETTING=VALUE`, or as\na key of the table `[ALGORITHM]` in a file for `--config`. "
        "[algorithms.md](algorithms.md) explains them.\n");
    for (const AlgorithmDescription& algorithm : all_algorithms()) print_settings(algorithm);
  });
}

}  // namespace osteomill::app
