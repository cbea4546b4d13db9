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

/// The distance of the burr's surface from one structure.
struct StructureReading {
  std::size_t structure = 0;
  double distance_mm = 0;
};

/// An exercise that is worked on in the window: what is shown of it, and what is measured at the end. For the
/// window's thread.
class ExerciseWork {
 public:
  /// `scan` is the bone before it is milled.
  ExerciseWork(PlacedExercise placed, const Volume& scan, RecordedExercise recorded);
  /// Gives up what is still being measured, and waits for that.
  ~ExerciseWork() { is_given_up_ = true; }
  ExerciseWork(const ExerciseWork&) = delete;
  ExerciseWork& operator=(const ExerciseWork&) = delete;

  const PlacedExercise& placed() const { return *placed_; }
  /// Returns what a recording says of the exercise, guidance as it is now.
  RecordedExercise recorded() const;

  bool has_guidance() const { return recorded_.has_guidance; }
  void show_guidance(bool on) { recorded_.has_guidance = on; }
  bool has_beat() const { return has_beat_; }
  void play_beat(bool on) { has_beat_ = on; }
  /// Returns the map that colours target, structures and bone to be kept.
  const std::shared_ptr<const LabelMap>& colours() const { return colours_; }

  /// Notes how far the steps are, some times a second.
  void update(const Volume& bone);
  /// Returns whether `update` has something to do.
  bool is_update_due() const;
  /// Returns the step that is worked on, from 1, the last one if all are done; 0 if there are none.
  std::size_t step() const { return step_; }
  /// Returns how much of its bone is gone, percent.
  double step_percent() const { return step_percent_; }

  /// Returns the structure that is nearest to the burr's surface; nothing without structures.
  std::optional<StructureReading> nearest(const Vec3& burr_W, double burr_radius_mm) const;
  /// Returns the beat for that structure; silent if it is off.
  BeatState beat(const Vec3& burr_W, double burr_radius_mm) const;

  /// Returns the view as a recording has it, 30 times a second; nothing in between.
  std::optional<ViewSample> next_view(const ViewState& view, const PixelSize& size, double time_s);

  /// Begins to measure a recording that is closed, and to write the results into a folder.
  void measure(const std::filesystem::path& recording, const std::filesystem::path& folder);
  bool is_measuring() const { return work_.valid(); }
  /// Takes the result once it is there. Throws what measuring failed with.
  void take_result();
  /// Returns the measured rows; empty before they are there.
  const std::vector<MeasuredValue>& results() const { return results_; }
  /// Returns the folder of the results.
  const std::filesystem::path& folder() const { return folder_; }
  /// Opens the page of the results in the desktop's browser. Throws InputError if there is no way to.
  void open_page() const;
  /// Forgets the results: the trainee goes on.
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
  std::atomic<bool> is_given_up_ = false;
  std::future<std::vector<MeasuredValue>> work_;
};

}  // namespace osteomill::app
