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

/// One tick of an attempt, with the data that measures need.
struct AttemptTick {
  double time_s = 0;
  double dt_s = 0;
  Vec3 burr_W = Vec3::Zero();
  double burr_radius_mm = 0;
  double force_N = 0;
  /// Bone removed in this tick, mm^3 of the reference density, as in TickRecord.
  double removed_mm3 = 0;
  bool spindle_on = false;
  /// Whether bone or the edge of the picture hid the burr's contact from the trainee; nothing if the burr did
  /// not cut or no view was recorded in the 0.2 s before.
  std::optional<bool> is_contact_hidden = {};
  /// False in pauses and without a pose; `burr_W` is then meaningless.
  bool is_placed = true;
  bool is_cutting() const { return removed_mm3 > 0; }
};

/// Thickness of the bone left over a point of a structure's surface.
struct ThicknessLeft {
  /// The structure's voxel at this point.
  VoxelIndex place;
  double left_mm = 0;
};

/// A recorded session together with its exercise.
struct Attempt {
  /// Owned by the caller.
  const PlacedExercise* exercise = nullptr;
  const Volume* scan = nullptr;
  /// Bone at the end, and the voxels of removed bone.
  Volume after;
  VoxelSet removed;
  std::vector<AttemptTick> ticks;
  /// Distance of the burr's surface from each structure, mm; structures are contiguous within a tick.
  std::vector<double> distances_mm;
  /// For each structure, the result of `osteomill::thickness_left`.
  std::vector<std::vector<ThicknessLeft>> thickness_left;
  /// Time at which each voxel of `removed` was removed, by its index in the scan.
  std::unordered_map<std::size_t, float> removal_times_s;
  std::vector<ViewSample> views;

  /// Returns when a voxel of the scan was removed, s; nothing if it was not.
  std::optional<double> removed_at_s(const VoxelIndex& v) const {
    const auto found = removal_times_s.find(row_major(exercise->scan.dims, v.i, v.j, v.k));
    if (found == removal_times_s.end()) return std::nullopt;
    return static_cast<double>(found->second);
  }
  /// Returns the distance from one structure in a tick, mm; NaN if the burr has no position.
  double distance_mm(std::size_t tick, std::size_t structure) const {
    return distances_mm[tick * exercise->structures.size() + structure];
  }
  /// Returns the distance from the nearest structure, mm; NaN without structures.
  double distance_mm(std::size_t tick) const;
};

/// Returns the ticks of a recording.
std::vector<AttemptTick> attempt_ticks(const Recording& recording);

/// Returns for each structure the thickness of the bone left over it, for every voxel of its surface over
/// which milling made it thinner by a voxel or more: the distance between the faces of the structure and of
/// the space open from outside, at most 8 mm. `removed` is the removed bone. Slow.
std::vector<std::vector<ThicknessLeft>> thickness_left(const PlacedExercise& exercise, const Volume& before,
                                                       const Volume& after, const VoxelSet& removed);

/// Repeats the recording's milling on the exercise's scan. Throws InputError, naming the recording, as
/// `repeat_milling`. `exercise` and `scan` must outlive the attempt. Slow.
Attempt make_attempt(const PlacedExercise& exercise, const Volume& scan, const Recording& recording);

/// Progress of an attempt at one time.
struct AttemptProgress {
  double time_s = 0;
  double target_removed_percent = 0;
  double removed_outside_mm3 = 0;
  double dice_percent = 0;
};
/// Returns the removal over time of the bone that is missing at the end, in 200 equal time steps; empty
/// without ticks.
std::vector<AttemptProgress> progress_of(const Attempt& attempt);

/// Returns when a step of the exercise was completed, s; NaN if it never was.
double step_completion_s(const Attempt& attempt, std::size_t step);

/// Returns whether a burr's contact point is hidden in a view: by bone that is not cut away in it, or because
/// it is outside the picture.
bool is_hidden(const ViewSample& view, const Volume& bone, const Vec3& contact_W);

/// Returns how often the view began to rotate, shift or zoom after half a second at rest; NaN without views.
double view_changes(const std::vector<ViewSample>& views);

/// A piece of the burr's path along which it cut without reversing.
struct Stroke {
  double duration_s = 0;
  double length_mm = 0;
};

/// Returns the strokes of a session. A stroke ends when the burr has not cut for 0.1 s, or when its path
/// turns by more than 90 degrees. The path is sampled in steps of 0.5 mm, as in k-cosine metrics, so that
/// tremor does not create strokes. Omits shorter pieces.
std::vector<Stroke> strokes_of(const std::vector<AttemptTick>& ticks);

}  // namespace osteomill
