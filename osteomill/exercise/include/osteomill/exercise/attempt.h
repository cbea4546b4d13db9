#pragma once

#include <cstddef>
#include <optional>
#include <unordered_map>
#include <vector>

#include "osteomill/exercise/placed_exercise.h"
#include "osteomill/recording/recording.h"
#include "osteomill/volume/volume.h"
#include "osteomill/volume/voxel_set.h"

namespace osteomill {

/// One tick of an attempt, as measures see it.
struct AttemptTick {
  double time_s = 0;
  double dt_s = 0;
  Vec3 burr_W = Vec3::Zero();
  double burr_radius_mm = 0;
  double force_N = 0;
  /// In mm^3 of the reference density, as TickRecord counts.
  double removed_mm3 = 0;
  bool spindle_on = false;
  /// Whether bone or the picture's edge hid the burr's contact from the trainee; nothing if it did not cut or
  /// no view was recorded.
  std::optional<bool> is_contact_hidden = {};
  /// False in pauses, and without a pose: then the burr's place means nothing.
  bool is_placed = true;
  bool is_cutting() const { return removed_mm3 > 0; }
};

/// The bone that milling left over a place of a structure's surface.
struct ThicknessLeft {
  /// The structure's voxel there.
  VoxelIndex place;
  double left_mm = 0;
};

/// A recorded session, held against its exercise.
struct Attempt {
  /// Stays the caller's.
  const PlacedExercise* exercise = nullptr;
  const Volume* scan = nullptr;
  /// The bone at the end, and which voxels are no longer bone.
  Volume after;
  VoxelSet removed;
  std::vector<AttemptTick> ticks;
  /// The distance of the burr's surface from each structure, mm, structure by structure in each tick.
  std::vector<double> distances_mm;
  /// By structure (`osteomill::thickness_left`).
  std::vector<std::vector<ThicknessLeft>> thickness_left;
  /// The time at which each voxel of `removed` went, by its index in the scan.
  std::unordered_map<std::size_t, float> removal_times_s;
  std::vector<ViewSample> views;

  /// Returns when a voxel of the scan was removed; nothing if it was not.
  std::optional<double> removed_at_s(const VoxelIndex& v) const {
    const auto found = removal_times_s.find(row_major(exercise->scan.dims, v.i, v.j, v.k));
    if (found == removal_times_s.end()) return std::nullopt;
    return static_cast<double>(found->second);
  }
  /// Returns the distance from one structure in a tick; not a number if the burr has no place.
  double distance_mm(std::size_t tick, std::size_t structure) const {
    return distances_mm[tick * exercise->structures.size() + structure];
  }
  /// Returns the distance from the nearest of all structures.
  double distance_mm(std::size_t tick) const;
};

/// Returns the ticks of a recording.
std::vector<AttemptTick> attempt_ticks(const Recording& recording);

/// Returns for each structure the bone that milling left over it at each voxel of its surface over which
/// it became thinner by a voxel or more: from face to face, between the structure and the space that is open
/// from outside, at most 8 mm. `removed` is the bone that is gone. Long work.
std::vector<std::vector<ThicknessLeft>> thickness_left(const PlacedExercise& exercise, const Volume& before,
                                                       const Volume& after, const VoxelSet& removed);

/// Runs the recording's milling again on the exercise's scan. Throws InputError, naming the recording, as
/// `repeat_milling` does. `exercise` and `scan` outlive the attempt. Long work.
Attempt make_attempt(const PlacedExercise& exercise, const Volume& scan, const Recording& recording);

/// How far an attempt was at one time.
struct AttemptProgress {
  double time_s = 0;
  double target_removed_percent = 0;
  double removed_outside_mm3 = 0;
  double dice_percent = 0;
};
/// Returns how the bone went that is gone at the end, in at most 200 equal steps of time; none without ticks.
std::vector<AttemptProgress> progress_of(const Attempt& attempt);

/// Returns when a step of the exercise was done; not a number if it never was.
double step_done_s(const Attempt& attempt, std::size_t step);

/// Returns whether the point where a burr presses is hidden in a view: by bone that is not cut away from the
/// view, or because it lies outside of the picture.
bool is_hidden(const ViewSample& view, const Volume& bone, const Vec3& contact_W);

/// Returns how often the view began to turn, shift or zoom after half a second at rest; not a number without
/// views.
double view_changes(const std::vector<ViewSample>& views);

/// A piece of the burr's path on which it cut and kept its direction.
struct Stroke {
  double duration_s = 0;
  double length_mm = 0;
};

/// Returns the strokes of a session. A stroke ends when the burr has not cut for 0.1 s, or when its path
/// turns by more than a right angle; the path is looked at in steps of 0.5 mm, as k-cosine metrics do, so
/// that a shaking hand makes no strokes. Shorter pieces are left out.
std::vector<Stroke> strokes_of(const std::vector<AttemptTick>& ticks);

}  // namespace osteomill
