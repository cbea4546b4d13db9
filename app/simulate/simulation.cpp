#include "app/simulate/simulation.h"

#include <cmath>
#include <functional>
#include <iterator>
#include <thread>
#include <utility>

#include "osteomill/base/input_error.h"
#include "osteomill/base/work_progress.h"
#include "osteomill/session/milling_entry.h"

#include "app/progress.h"

namespace osteomill::app {

namespace {

using namespace std::chrono_literals;

constexpr double kHistory_s = 5;
constexpr const char* kMilledIsovalue = "as it was milled with";

HandleSettings handle_settings(const MillingSetup& setup) {
  HandleSettings handle;
  handle.limits = setup.guard.limits;
  return handle;
}

std::string isovalue_source(const ScanOptions& scan, const LoadedBone& loaded) {
  return scan.isovalue ? "given with --iso" : "suggested: " + loaded.isovalue_from;
}

}  // namespace

using Prepare = std::function<PreparedMilling(std::shared_ptr<Volume> bone)>;

static PreparedScan prepare_scan(const ScanOptions& scan, LoadedBone loaded, const MillingTool& tool,
                                 const std::string& isovalue_from, const Prepare& prepare) {
  auto bone = std::make_shared<Volume>(std::move(loaded.volume));
  const BoneBox box = box_of_bone(*bone);
  if (const std::string fault = tool_fault(tool, box); !fault.empty()) throw InputError(loaded.name, fault);
  const DensityHistogram histogram = histogram_of(bone->grid());
  std::vector<Boundary> boundaries = boundaries_in(bone->grid());
  const WorkProgress::Part preparing(1);
  PreparedMilling prepared = prepare(bone);
  const WindowLevel grey_window = window_level_of(bone->grid(), prepared.session->densities().surroundings);
  return {{loaded.name, scan, bone->isovalue(), isovalue_from, loaded.in_hounsfield_units ? " HU" : "", box,
           histogram, std::move(boundaries), grey_window, bone->labels()},
          std::move(prepared),
          nullptr};
}

PreparedScan open_for_milling(const ScanOptions& scan, const MillingSetup& setup,
                              const SessionStart& milled) {
  LoadedBone loaded = [&] {
    const WorkProgress::Part reading(0.4);
    return load_bone(scan);
  }();
  const std::string isovalue_from = milled.bricks.empty() ? isovalue_source(scan, loaded) : kMilledIsovalue;
  return prepare_scan(scan, std::move(loaded), setup.tool, isovalue_from, [&](std::shared_ptr<Volume> bone) {
    return prepare_milling(std::move(bone), setup, milled);
  });
}

PreparedScan open_exercise(const ExerciseOptions& exercise, const ScanOptions& scan, MillingSetup setup) {
  LoadedExercise loaded = [&] {
    const WorkProgress::Part reading(0.4);
    return load_exercise(exercise.file, scan);
  }();
  take_allowed_burr(loaded.placed.exercise, setup);
  RecordedExercise recorded = to_be_recorded(loaded.placed.exercise, exercise);
  const ScanOptions source = scan_of(loaded.placed.exercise, scan);
  auto work =
      std::make_unique<ExerciseWork>(std::move(loaded.placed), loaded.bone.volume, std::move(recorded));
  const std::string isovalue_from = isovalue_source(source, loaded.bone);
  PreparedScan prepared =
      prepare_scan(source, std::move(loaded.bone), setup.tool, isovalue_from,
                   [&](std::shared_ptr<Volume> bone) { return prepare_milling(std::move(bone), setup); });
  prepared.exercise = std::move(work);
  return prepared;
}

PreparedScan open_for_branch(const BranchOptions& from, const ScanOptions& scan,
                             const ExerciseOptions& exercise, const GuardSettings& guard) {
  Branch branch = [&] {
    const WorkProgress::Part replaying(0.7);
    return open_branch(from, scan, exercise);
  }();
  RecordedWork& work = branch.work;
  std::unique_ptr<ExerciseWork> task;
  if (work.placed)
    task = std::make_unique<ExerciseWork>(*std::move(work.placed), work.bone.volume, *work.exercise);
  PreparedScan prepared = prepare_scan(
      work.scan, std::move(work.bone), branch.resumed.session->setup().tool, kMilledIsovalue,
      [&](std::shared_ptr<Volume> bone) { return prepare_milling(std::move(bone), branch.resumed, guard); });
  prepared.exercise = std::move(task);
  prepared.from = branch.from;
  return prepared;
}

PreparedScan open_for_playback(const std::string& recording, const ScanOptions& scan,
                               const ExerciseOptions& exercise) {
  RecordedWork work = [&] {
    const WorkProgress::Part reading(0.4);
    return read_recorded_work(recording, scan, exercise);
  }();
  const WorkProgress::Part milling(1);
  ScanInfo info{.name = recording, .source = work.scan};
  return {.scan = std::move(info), .playback = std::make_unique<Playback>(std::move(work))};
}

Simulation::Simulation(PreparedScan opened, const Pose& X_WT, const ToolSource& tool_source_,
                       const std::string& command_line_, std::optional<AutosaveFile> autosave_file)
    : scan(std::move(opened.scan)),
      exercise(std::move(opened.exercise)),
      from(std::move(opened.from)),
      command_line(command_line_),
      tool_source(tool_source_),
      hand(handle_settings(opened.milling.session->setup()), pointing_hand(), X_WT),
      device(take_tool(opened.milling.session->setup(), opened.milling.session->volume(), X_WT)),
      milling(std::move(opened.milling), device),
      autosave(scan.source, std::move(autosave_file)),
      label_count(scan.labels) {}

void Simulation::start() {
  milling.start();
  // Drawing and dragging begin at the tool, so wait for its first tick.
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

// Looks for warnings on a thread of its own, because it goes through every voxel.
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

// Goes through all that was ever milled, so not at every picture.
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
