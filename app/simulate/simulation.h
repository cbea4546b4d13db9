#pragma once

#include <deque>
#include <string>

#include "app/scan_options.h"

#include "osteomill/live/live_milling.h"
#include "osteomill/operator/milling_entry.h"
#include "osteomill/operator/virtual_hand.h"
#include "osteomill/view/clip_face.h"
#include "osteomill/volume/density_histogram.h"

namespace osteomill::app {

/// A scan made ready for milling, and what the window shows of it beside its surface.
struct OpenedScan {
  std::string name;
  MillingEntry entry;
  DensityHistogram histogram;
  WindowLevel grey_window;
  PreparedMilling milling;
};

/// Takes seconds; in any thread, also while another scan is milled. Throws InputError as `load_bone` does,
/// and std::invalid_argument for settings out of range.
OpenedScan open_for_milling(const ScanOptions& scan, const MillingSetup& setup);

/// A scan that is being milled by a virtual hand. Begins to tick when it is made; one at a time.
struct Simulation {
  Simulation(OpenedScan opened, const std::string& command_line);

  /// Once a picture: as LiveMilling::update, and keeps the ticks.
  void update();

  std::string scan_name;
  std::string command_line;
  MillingEntry entry;
  DensityHistogram histogram;
  WindowLevel grey_window;
  VirtualHand hand;
  LiveMilling milling;
  /// The ticks of the last 5 seconds.
  std::deque<TickRecord> history;
};

}  // namespace osteomill::app
