#include "app/simulate/simulation.h"

#include <chrono>
#include <memory>
#include <thread>
#include <utility>

#include "osteomill/numbers/work_progress.h"

namespace osteomill::app {

namespace {

constexpr std::size_t kHistory = 5000;

HandleSettings handle_settings(const MillingSetup& setup) {
  HandleSettings handle;
  handle.limits = setup.limits;
  return handle;
}

}  // namespace

OpenedScan open_for_milling(const ScanOptions& scan, const MillingSetup& setup) {
  LoadedBone loaded = [&] {
    const WorkProgress::Part reading(0.4);
    return load_bone(scan);
  }();
  auto bone = std::make_shared<Volume>(std::move(loaded.volume));
  const MillingEntry entry = [&] {
    const WorkProgress::Part looking(0.45);
    return place_entry(*bone, setup.tool);
  }();
  const DensityHistogram histogram = histogram_of(bone->grid());
  const WorkProgress::Part preparing(1);
  PreparedMilling milling = prepare_milling(bone, setup);
  const WindowLevel grey_window = window_level_of(bone->grid(), milling.densities.surroundings);
  return {loaded.name, entry, histogram, grey_window, std::move(milling)};
}

Simulation::Simulation(OpenedScan opened, const std::string& command_line_)
    : scan_name(std::move(opened.name)),
      command_line(command_line_),
      entry(opened.entry),
      histogram(opened.histogram),
      grey_window(opened.grey_window),
      hand(handle_settings(opened.milling.setup), pointing_hand(),
           pose_above(entry, opened.milling.setup.tool, kStartAbove_mm)),
      milling(std::move(opened.milling), hand) {
  milling.start();
  // What is drawn and pulled begins at the tool, so its first tick is waited for.
  while (history.empty() && milling.running()) {
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    if (const auto record = milling.next_record()) history.push_back(*record);
  }
}

void Simulation::update() {
  while (const auto record = milling.next_record()) history.push_back(*record);
  while (history.size() > kHistory) history.pop_front();
  milling.update();
}

}  // namespace osteomill::app
