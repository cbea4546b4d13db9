#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/exercise/measures.h"
#include "osteomill/exercise/placed_exercise.h"
#include "osteomill/exercise/recorded_exercise.h"
#include "osteomill/recording/view_sample.h"
#include "osteomill/visual/camera.h"
#include "osteomill/visual/distance_beat.h"
#include "osteomill/volume/label_map.h"
#include "osteomill/volume/volume.h"

#include "app/simulate/view_state.h"

namespace osteomill::app {

/// Distance from the burr's surface to a structure.
struct StructureReading {
  std::size_t structure = 0;
  double distance_mm = 0;
};

/// An exercise in progress in the window: its guidance, and its results at the end. For the window's thread.
class ExerciseWork {
 public:
  /// `scan` is the bone before milling.
  ExerciseWork(PlacedExercise placed, const Volume& scan, RecordedExercise recorded);
  /// Cancels measuring and waits until it has stopped.
  ~ExerciseWork() { is_cancelled_ = true; }
  ExerciseWork(const ExerciseWork&) = delete;
  ExerciseWork& operator=(const ExerciseWork&) = delete;

  const PlacedExercise& placed() const { return *placed_; }
  /// Returns the exercise data for a recording, with the present state of guidance.
  RecordedExercise recorded() const;

  bool has_guidance() const { return recorded_.has_guidance; }
  void show_guidance(bool on) { recorded_.has_guidance = on; }
  bool has_beat() const { return has_beat_; }
  void play_beat(bool on) { has_beat_ = on; }
  /// Returns the map that colours target, structures and bone to keep.
  const std::shared_ptr<const LabelMap>& colours() const { return colours_; }

  /// Updates the progress of the steps; effective a few times a second.
  void update(const Volume& bone);
  /// Returns whether `update` has work to do.
  bool is_update_due() const;
  /// Returns the current step, counted from 1; the last one if all are done, 0 if there are none.
  std::size_t step() const { return step_; }
  /// Returns the part of the step's bone that is removed, percent.
  double step_percent() const { return step_percent_; }

  /// Returns the structure nearest to the burr's surface; std::nullopt without structures.
  std::optional<StructureReading> nearest(const Vec3& burr_W, double burr_radius_mm) const;
  /// Returns the beat for that structure; silent if the beat is off.
  BeatState beat(const Vec3& burr_W, double burr_radius_mm) const;

  /// Returns the view to record, 30 times a second; otherwise std::nullopt.
  std::optional<ViewSample> next_view(const ViewState& view, const PixelSize& size, double time_s);

  /// Starts measuring a closed recording; writes the results into a folder.
  void measure(const std::filesystem::path& recording, const std::filesystem::path& folder);
  bool is_measuring() const { return work_.valid(); }
  /// Takes the results once they are ready. Throws the exception of measuring.
  void take_result();
  /// Returns the measured rows; empty until they are ready.
  const std::vector<MeasuredValue>& results() const { return results_; }
  /// Returns the folder of the results.
  const std::filesystem::path& folder() const { return folder_; }
  /// Opens the page of results in the desktop's browser. Throws InputError if that is not possible.
  void open_page() const;
  /// Discards the results because the trainee continues.
  void close_results() { results_.clear(); }

 private:
  using Clock = std::chrono::steady_clock;

  std::shared_ptr<const PlacedExercise> placed_;
  std::shared_ptr<const Volume> scan_;
  RecordedExercise recorded_;
  std::shared_ptr<const LabelMap> colours_;
  bool has_beat_ = true;
  std::size_t step_ = 0;
  double step_percent_ = 0;
  Clock::time_point updated_;
  double next_view_s_ = 0;
  std::filesystem::path folder_;
  std::vector<MeasuredValue> results_;
  std::atomic<bool> is_cancelled_ = false;
  std::future<std::vector<MeasuredValue>> work_;
};

}  // namespace osteomill::app
