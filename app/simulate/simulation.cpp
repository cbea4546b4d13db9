#include "app/simulate/simulation.h"

#include <cmath>
#include <functional>
#include <iterator>
#include <thread>
#include <utility>

#include "osteomill/session/milling_entry.h"

#include "app/progress.h"

namespace osteomill::app {

namespace {

using namespace std::chrono_literals;

constexpr double kHistory_s = 5;

HandleSettings handle_settings(const MillingSetup& setup) {
  HandleSettings handle;
  handle.limits = setup.guard.limits;
  return handle;
}

}  // namespace

Simulation::Simulation(PreparedScan opened, const Pose& X_WT, const ToolSource& tool_source_,
                       const std::string& command_line_)
    : scan(std::move(opened.scan)),
      exercise(std::move(opened.exercise)),
      from(std::move(opened.from)),
      command_line(command_line_),
      tool_source(tool_source_),
      hand(handle_settings(opened.milling.session->setup()), pointing_hand(), X_WT),
      device(take_tool(opened.milling.session->setup(), opened.milling.session->volume(), X_WT)),
      milling(std::move(opened.milling), device),
      autosave(scan.source, std::move(opened.milled_file)),
      label_count(scan.labels) {}

void Simulation::start() {
  milling.start();
  // Wait for the first tick, because drawing and dragging start from the tool's pose.
  while (history.empty() && milling.is_running()) {
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    if (const auto record = milling.next_record()) history.push_back(*record);
  }
}

Device& Simulation::take_tool(const MillingSetup& setup, const Volume& bone, const Pose& X_WT) {
  if (tool_source.hardware != nullptr) {
    tool_source.hardware->put_at(X_WT);
    return *tool_source.hardware;
  }
  if (tool_source.is_pointer()) return hand;
  OperatorSettings settings;
  settings.handle = handle_settings(setup);
  return simulated.emplace(settings, setup.tool, place_entry(bone, setup.tool, {}, {}, scan.name));
}

RunDescription Simulation::describe() const {
  RunDescription run = milling.describe(scan.name, command_line);
  std::ranges::move(scan_settings(scan.source), std::back_inserter(run.settings));
  describe_device(run, tool_source.name, tool_source.hardware);
  if (exercise) put_exercise(run, exercise->recorded());
  if (from) put_branch_point(run, *from);
  return run;
}

std::size_t Simulation::max_history() const {
  return static_cast<std::size_t>(std::lround(kHistory_s / milling.setup().tick_s));
}

void Simulation::update() {
  while (const auto record = milling.next_record()) {
    history.push_back(*record);
    if (const auto touched = label_count.add(*record)) warn(no_go_text = *touched);
  }
  while (history.size() > max_history()) history.pop_front();
  milling.update();
  if (exercise && exercise->is_update_due())
    milling.follower().read([&](const Volume& bone) { exercise->update(bone); });
  autosave.update(milling);
  count_labels();
  update_warnings();
}

// Computes the warnings on a thread of its own, because that scans every voxel.
void Simulation::update_warnings() {
  if (pending_warnings_.valid()) {
    if (pending_warnings_.wait_for(0s) == std::future_status::ready) warnings = pending_warnings_.get();
  } else if (std::tuple now(milling.isovalue(), milling.setup().tool.burr_radius_mm,
                            setting_warnings(milling.setup(), milling.geometry()));
             now != warned_inputs_) {
    warned_inputs_ = now;
    pending_warnings_ = std::async(std::launch::async, [this, now, tool = milling.setup().tool] {
      std::vector<std::string> found = std::get<2>(now);
      milling.follower().read([&](const Volume& bone) {
        for (const auto& more :
             {coarseness_warnings(bone.geometry(), tool), isovalue_warnings(bone.grid(), std::get<0>(now))})
          found.insert(found.end(), more.begin(), more.end());
      });
      return found;
    });
  }
}

// Not in every frame, because it scans everything milled so far.
void Simulation::count_labels() {
  constexpr auto kEvery = std::chrono::milliseconds(500);
  const auto now = std::chrono::steady_clock::now();
  const std::uint64_t version = milling.follower().version();
  if (!scan.labels || version == counted_version_ || now - counted_ < kEvery) return;
  removed_by_label_mm3 = milling.removed_by_label();
  counted_version_ = version;
  counted_ = now;
}

}  // namespace osteomill::app
