#pragma once

#include <optional>
#include <string>

#include "app/device_option.h"
#include "app/scan_options.h"

#include "osteomill/session/milling_setup.h"
#include "osteomill/view/camera.h"

namespace osteomill::app {

struct SimulatorOptions {
  ScanOptions scan;
  MillingSetup setup;
  DeviceOption device{kMouse};
  SendOption send;
  PixelSize size{1280, 800};
  /// How much larger than usual text is; not given: as the screen asks for.
  std::optional<double> ui_scale;
  /// Works the window in place of a person (ui_script.h); empty: nobody does.
  std::string script;
  bool no_help = false;
  /// Where recordings and what is saved go.
  std::string folder = ".";
  std::string command_line;
};

/// Opens the window and returns when it is closed. Throws InputError where no window can be opened, the
/// device cannot be had, or the scan is at fault.
void run_simulator(const SimulatorOptions& options);

}  // namespace osteomill::app
