#include "app/simulate/opening.h"

#include <functional>
#include <utility>

#include <malloc.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/work_progress.h"

#include "app/memory_limit.h"
#include "app/progress.h"

namespace osteomill::app {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Prepare = std::function<PreparedMilling(std::shared_ptr<Volume> bone)>;

constexpr const char* kMilledIsovalue = "from the earlier session";

// Stops reading a folder before its pixels are read.
struct SeveralSeries {
  std::vector<SeriesSummary> series;
};

std::string isovalue_source(const ScanOptions& scan, const LoadedBone& loaded) {
  return scan.isovalue ? "given with --iso" : "suggested: " + loaded.isovalue_from;
}

PreparedScan prepare_scan(const ScanOptions& scan, LoadedBone loaded, const MillingTool& tool,
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

PreparedScan open_for_milling(const OpenRequest& request, const MillingSetup& setup) {
  const ScanOptions& scan = request.scan;
  const SessionStart milled = request.milled ? request.milled->start : SessionStart{};
  ScanOptions asking = scan;
  if (!request.milled)
    asking.read.choose_series = [](const auto& series) -> std::string { throw SeveralSeries{series}; };
  std::optional<LoadedBone> read;
  try {
    const WorkProgress::Part reading(0.4);
    read = load_bone(asking);
  } catch (const SeveralSeries& several) {
    return {.scan = {.name = scan.scan, .source = scan}, .series = several.series};
  }
  LoadedBone& loaded = *read;
  const std::string isovalue_from = milled.bricks.empty() ? isovalue_source(scan, loaded) : kMilledIsovalue;
  PreparedScan prepared = prepare_scan(
      scan, std::move(loaded), setup.tool, isovalue_from,
      [&](std::shared_ptr<Volume> bone) { return prepare_milling(std::move(bone), setup, milled); });
  if (request.milled) prepared.milled_file = request.milled->file;
  return prepared;
}

PreparedScan open_exercise(const ExerciseOptions& exercise, const ScanOptions& scan, MillingSetup setup) {
  LoadedExercise loaded = [&] {
    const WorkProgress::Part reading(0.4);
    return load_exercise(exercise.file, scan);
  }();
  select_allowed_burr(loaded.placed.exercise, setup);
  RecordedExercise recorded = make_recorded_exercise(loaded.placed.exercise, exercise);
  const ScanOptions source = scan_of(loaded.placed.exercise, scan);
  auto work =
      std::make_unique<ExerciseWork>(std::move(loaded.placed), loaded.bone.volume, std::move(recorded));
  const std::string isovalue_from =
      source.isovalue ? "from the exercise" : isovalue_source(source, loaded.bone);
  PreparedScan prepared =
      prepare_scan(source, std::move(loaded.bone), setup.tool, isovalue_from,
                   [&](std::shared_ptr<Volume> bone) { return prepare_milling(std::move(bone), setup); });
  prepared.exercise = std::move(work);
  return prepared;
}

PreparedScan open_for_branch(const OpenRequest& request, const GuardSettings& guard) {
  Branch branch = [&] {
    const WorkProgress::Part replaying(0.7);
    return open_branch(request.from, request.scan, request.exercise);
  }();
  LoadedRecording& work = branch.work;
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

// The recording names its scan and how to read it.
PreparedScan open_for_playback(const OpenRequest& request) {
  const ScanOptions& scan = request.scan;
  ScanOptions recorded;
  recorded.read.max_memory_bytes = scan.read.max_memory_bytes;
  LoadedRecording work = [&] {
    const WorkProgress::Part reading(0.4);
    return load_recording(scan.scan, recorded, {});
  }();
  if (request.from.at_s != 0) ticks_until(work.recording, request.from.at_s);
  const WorkProgress::Part milling(1);
  ScanInfo info{.name = scan.scan, .source = work.scan};
  return {.scan = std::move(info),
          .playback = std::make_unique<Playback>(std::move(work)),
          .play_at_s = request.from.at_s};
}

}  // namespace

std::string OpenRequest::name() const {
  if (from.given()) return from.recording;
  if (exercise.given()) return exercise.file;
  return scan.scan.empty() ? kBuiltinTooth : scan.scan;
}

PreparedScan open_requested(const OpenRequest& request, MillingSetup setup) {
  if (request.from.given()) return open_for_branch(request, setup.guard);
  if (request.exercise.given()) return open_exercise(request.exercise, request.scan, std::move(setup));
  if (is_hdf5(request.scan.scan)) return open_for_playback(request);
  return open_for_milling(request, setup);
}

void Opening::begin(OpenRequest request, const MillingSetup& setup) {
  stop();
  since_ = Clock::now();
  request_ = std::make_shared<const OpenRequest>(std::move(request));
  work_ = std::make_shared<Work>();
  result_ = std::async(std::launch::async, [work = work_, request = request_, setup] {
    try {
      const WorkProgress progress([&](double share) {
        work->share_done = share;
        if (work->stopped) throw WorkStopped();
        check_memory_limit();
      });
      return open_requested(*request, setup);
    } catch (const WorkStopped&) {
      ::malloc_trim(0);
      throw;
    }
  });
}

void Opening::stop() {
  std::erase_if(stopped_, [](const auto& ended) { return ended.wait_for(0s) == std::future_status::ready; });
  if (!result_.valid()) return;
  work_->stopped = true;
  stopped_.push_back(std::move(result_));
}

bool Opening::is_ready() const {
  return result_.valid() && result_.wait_for(0s) == std::future_status::ready;
}

PreparedScan Opening::take() {
  request_.reset();
  return result_.get();
}

double Opening::passed_s() const {
  return std::chrono::duration<double>(Clock::now() - since_).count();
}

}  // namespace osteomill::app
