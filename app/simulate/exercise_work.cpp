#include "app/simulate/exercise_work.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "osteomill/base/input_error.h"
#include "osteomill/base/run_program.h"
#include "osteomill/base/work_progress.h"
#include "osteomill/exercise/debriefing.h"

#include "app/simulate/scene_of.h"

namespace osteomill::app {

namespace {

using namespace std::chrono_literals;

std::size_t gone_of(const VoxelSet& voxels, const Volume& bone) {
  std::size_t gone = 0;
  voxels.for_each([&](const VoxelIndex& v) {
    if (!bone.is_bone(v)) ++gone;
  });
  return gone;
}

}  // namespace

ExerciseWork::ExerciseWork(PlacedExercise placed, const Volume& scan, RecordedExercise recorded)
    : placed_(std::make_shared<const PlacedExercise>(std::move(placed))),
      scan_(std::make_shared<const Volume>(scan)),
      recorded_(std::move(recorded)),
      colours_(colours_of(*placed_)) {
  update(scan);
}

RecordedExercise ExerciseWork::recorded() const {
  return recorded_;
}

bool ExerciseWork::is_update_due() const {
  return Clock::now() - updated_ >= 300ms;
}

void ExerciseWork::update(const Volume& bone) {
  updated_ = Clock::now();
  const std::vector<VoxelSet>& steps = placed_->steps;
  for (step_ = steps.empty() ? 0 : 1; step_ > 0; ++step_) {
    const VoxelSet& voxels = steps[step_ - 1];
    step_percent_ = 100 * static_cast<double>(gone_of(voxels, bone)) / static_cast<double>(voxels.count());
    if (step_ == steps.size() || step_percent_ < placed_->exercise.steps[step_ - 1].done_percent) break;
  }
}

std::optional<StructureReading> ExerciseWork::nearest(const Vec3& burr_W, double burr_radius_mm) const {
  std::optional<StructureReading> nearest;
  for (std::size_t n = 0; n < placed_->distances->size(); ++n) {
    const double distance_mm = (*placed_->distances)[n].distance.from(burr_W) - burr_radius_mm;
    if (!nearest || distance_mm < nearest->distance_mm) nearest = {n, distance_mm};
  }
  return nearest;
}

BeatState ExerciseWork::beat(const Vec3& burr_W, double burr_radius_mm) const {
  const auto reading = nearest(burr_W, burr_radius_mm);
  if (!reading || !has_beat_ || !has_guidance()) return {};
  return distance_beat(reading->distance_mm, placed_->structures[reading->structure].warn_mm,
                       reading->structure);
}

std::optional<ViewSample> ExerciseWork::next_view(const ViewState& view, const PixelSize& size,
                                                  double time_s) {
  constexpr double kEvery_s = 1.0 / 30;
  // After a pause the next sample is due at once; the time of a session never decreases.
  if (time_s < next_view_s_) return std::nullopt;
  next_view_s_ = std::max(next_view_s_ + kEvery_s, time_s);
  ViewSample sample;
  sample.time_s = time_s;
  sample.X_WC = {view.camera.eye_W(), view.camera.orientation};
  sample.field_of_view_rad = view.camera.field_of_view_rad;
  sample.aspect = static_cast<double>(size.width) / std::max(size.height, 1);
  for (std::size_t n = 0; n < view.cuts.size(); ++n) {
    if (!view.cuts[n].on) continue;
    const ClipPlane plane = plane_of(view.cuts[n]);
    sample.cuts[n] = {plane.normal_W, plane.offset_mm};
  }
  sample.step = static_cast<int>(step_);
  sample.has_guidance = has_guidance();
  return sample;
}

void ExerciseWork::measure(const std::filesystem::path& recording, const std::filesystem::path& folder) {
  folder_ = folder;
  results_.clear();
  work_ = std::async(std::launch::async, [this, placed = placed_, scan = scan_, recording, folder] {
    const WorkProgress watched([this](double) {
      if (is_cancelled_) throw WorkStopped();
    });
    const Recording recorded = read_recording(recording);
    const Attempt attempt = make_attempt(*placed, *scan, recorded);
    const DebriefedAttempt own = debriefed(attempt, recorded);
    write_debriefing(folder, attempt, recorded, own, load_peers(attempt, recorded));
    return own.rows;
  });
}

void ExerciseWork::open_page() const {
  // Do not wait for the browser, which outlives the window.
  const std::string open = "command -v xdg-open >/dev/null && exec setsid -f xdg-open \"$1\" >/dev/null 2>&1";
  const std::string page = (folder_ / "debrief.html").string();
  if (run_program({"sh", "-c", open, "sh", page}).exit_code != 0)
    throw InputError(page, "cannot be opened without xdg-open (package xdg-utils)");
}

void ExerciseWork::take_result() {
  if (work_.valid() && work_.wait_for(0s) == std::future_status::ready) results_ = work_.get();
}

}  // namespace osteomill::app
