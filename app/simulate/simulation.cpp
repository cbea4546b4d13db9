#include "app/simulate/simulation.h"

#include <chrono>
#include <memory>
#include <thread>
#include <utility>

#include "osteomill/files/input_error.h"
#include "osteomill/numbers/work_progress.h"

namespace osteomill::app {

namespace {

constexpr std::size_t kHistory = 5000;

HandleSettings handle_settings(const MillingSetup& setup) {
  HandleSettings handle;
  handle.limits = setup.limits;
  return handle;
}

std::string isovalue_from(const ScanOptions& scan, const LoadedBone& loaded, bool milled) {
  if (milled) return "as it was milled with";
  return scan.isovalue ? "given with --iso" : "suggested: " + loaded.isovalue_from;
}

std::string absolute_path(const std::string& scan) {
  return scan.empty() ? scan : std::filesystem::absolute(scan).lexically_normal().string();
}

}  // namespace

OpenedScan open_for_milling(const ScanOptions& scan, const MillingSetup& setup,
                            const std::filesystem::path& milled) {
  LoadedBone loaded = [&] {
    const WorkProgress::Part reading(0.4);
    return load_bone(scan);
  }();
  const DensityGrid& grid = loaded.volume.grid();
  MilledBone as_scanned = {
      absolute_path(scan.scan), loaded.name, loaded.volume.isovalue(), 0, grid.geometry().dims,
      fingerprint_of(grid),     {}};
  MilledBefore before;
  if (!milled.empty()) {
    MilledBone kept = read_milled_bone(milled);
    require_same_scan(kept, as_scanned);
    before = {std::move(kept.bricks), kept.removed_mm3};
  }
  auto bone = std::make_shared<Volume>(std::move(loaded.volume));
  const BoneBox box = box_of_bone(*bone);
  if (const std::string fault = tool_fault(setup.tool, box); !fault.empty())
    throw InputError(loaded.name, fault);
  const DensityHistogram histogram = histogram_of(bone->grid());
  const WorkProgress::Part preparing(1);
  PreparedMilling prepared = prepare_milling(bone, setup, before);
  const WindowLevel grey_window = window_level_of(bone->grid(), prepared.densities.surroundings);
  return {loaded.name,
          std::move(as_scanned),
          isovalue_from(scan, loaded, !milled.empty()),
          loaded.in_hounsfield_units ? " HU" : "",
          box,
          histogram,
          grey_window,
          std::move(prepared)};
}

Simulation::Simulation(OpenedScan opened, const Pose& X_WT, const std::string& command_line_,
                       std::optional<AutosaveFile> autosave_file)
    : scan_name(std::move(opened.name)),
      command_line(command_line_),
      first_isovalue(opened.as_scanned.isovalue),
      isovalue_from(std::move(opened.isovalue_from)),
      unit(std::move(opened.unit)),
      histogram(opened.histogram),
      grey_window(opened.grey_window),
      hand(handle_settings(opened.milling.setup), pointing_hand(), X_WT),
      milling(std::move(opened.milling), hand),
      autosave(std::move(opened.as_scanned), std::move(autosave_file)) {
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
  autosave.update(milling);
}

}  // namespace osteomill::app
