#include "osteomill/exercise/attempt.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "osteomill/base/work_progress.h"
#include "osteomill/exercise/region_voxels.h"
#include "osteomill/recording/replay_recording.h"
#include "osteomill/volume/nearest_voxels.h"
#include "osteomill/volume/sampling.h"

namespace osteomill {

namespace {

// Splits the burr's path while cutting into strokes.
class StrokeFinder {
 public:
  void add(const AttemptTick& tick) {
    if (!tick.is_cutting()) {
      pause_s_ += tick.dt_s;
      if (pause_s_ >= kPause_s) end();
      return;
    }
    if (!begun_) begin_at(tick.burr_W);
    // A short pause in cutting belongs to the stroke.
    current_.duration_s += std::exchange(pause_s_, 0) + tick.dt_s;
    const Vec3 step = tick.burr_W - corner_;
    beyond_mm_ = std::max(beyond_mm_, step.dot(direction_));
    if (step.norm() < kStep_mm) return;
    if (step.dot(direction_) < 0) {
      // The path turned between its last corner and here, at its farthest point.
      const Vec3 turn_W = corner_ + beyond_mm_ * direction_;
      end();
      begin_at(turn_W);
    }
    follow(tick.burr_W);
  }
  std::vector<Stroke> strokes() {
    end();
    return std::move(strokes_);
  }

 private:
  static constexpr double kStep_mm = 0.5;
  static constexpr double kPause_s = 0.1;

  void begin_at(const Vec3& corner_W) {
    begun_ = true;
    pause_s_ = 0;
    corner_ = corner_W;
    direction_ = Vec3::Zero();
    beyond_mm_ = 0;
    current_ = {};
  }
  void follow(const Vec3& burr_W) {
    const Vec3 step = burr_W - corner_;
    current_.length_mm += step.norm();
    direction_ = step.normalized();
    corner_ = burr_W;
    beyond_mm_ = 0;
  }
  void end() {
    current_.length_mm += beyond_mm_;
    if (begun_ && current_.length_mm >= kStep_mm) strokes_.push_back(current_);
    begun_ = false;
  }

  std::vector<Stroke> strokes_;
  Stroke current_;
  Vec3 corner_ = Vec3::Zero();
  // Direction of the last step, zero in the first of a stroke, and the largest distance along it since.
  Vec3 direction_ = Vec3::Zero();
  double beyond_mm_ = 0;
  double pause_s_ = 0;
  bool begun_ = false;
};

// Returns the bone left over a structure, given the space that was open before and the space that milling
// opened. Searches only near the opened space.
std::vector<ThicknessLeft> thickness_over(const PlacedExercise& exercise, const VoxelSet& structure,
                                          const VoxelSet& open_before, const VoxelSet& opened) {
  const Vec3& spacing_mm = exercise.scan.spacing_mm;
  constexpr double kReach_mm = 8;
  const double voxel_mm = spacing_mm.minCoeff();
  const auto reach = static_cast<int>(std::ceil(kReach_mm / voxel_mm)) + 1;
  const VoxelBox near = structure.box().intersected(opened.box().grown(reach));
  std::vector<ThicknessLeft> left;
  if (opened.box().empty() || near.empty()) return left;
  // Space that was already open at the beginning was not opened by the trainee.
  const VoxelBox box = near.grown(reach).intersected(exercise.scan.all_voxels());
  const NearestVoxels before(open_before, box, spacing_mm), after(opened, box, spacing_mm);
  for_each(near, [&](const VoxelIndex& v) {
    if (!structure.contains(v)) return;
    const double now_mm = after.distance_mm(v);
    if (!(now_mm <= kReach_mm) || now_mm > before.distance_mm(v) - voxel_mm) return;
    // Skips voxels inside the structure: only its surface counts.
    const VoxelIndex open = after.nearest_to(v);
    const Vec3 way(open.i - v.i, open.j - v.j, open.k - v.k);
    const Vec3 next = (Vec3(v.i, v.j, v.k) + way / way.cwiseAbs().maxCoeff()).array().round();
    const VoxelIndex beside{static_cast<int>(next.x()), static_cast<int>(next.y()),
                            static_cast<int>(next.z())};
    if (!structure.contains(beside)) left.push_back({v, std::max(0.0, now_mm - voxel_mm)});
  });
  return left;
}

// Records when each voxel ceased to be bone.
class RemovalTimes {
 public:
  explicit RemovalTimes(const Volume& scan) : scan_(scan), seen_(scan.geometry().voxel_count()) {}

  void add(const Volume& bone, const VoxelBox& changed, double time_s) {
    const std::array<int, 3>& dims = bone.geometry().dims;
    // Bone may have been restored at the start of a session.
    if (changed == bone.geometry().all_voxels())
      std::erase_if(times_s_,
                    [&](const auto& one) { return !(seen_[one.first] = !is_bone(bone, one.first)); });
    for_each(changed, [&](const VoxelIndex& v) {
      if (bone.is_bone(v)) return;
      const std::size_t voxel = row_major(dims, v.i, v.j, v.k);
      if (seen_[voxel]) return;
      seen_[voxel] = true;
      if (scan_.is_bone(v)) times_s_.emplace(voxel, static_cast<float>(time_s));
    });
  }
  std::unordered_map<std::size_t, float> take() { return std::move(times_s_); }

 private:
  static bool is_bone(const Volume& bone, std::size_t voxel) {
    const auto [i, j, k] = cell_at(bone.geometry().dims, voxel);
    return bone.is_bone({i, j, k});
  }

  const Volume& scan_;
  std::unordered_map<std::size_t, float> times_s_;
  // Voxels already found not to be bone; most changed voxels are in this set.
  std::vector<bool> seen_;
};

// Sets for each cutting tick whether its contact was hidden. Evaluates each view once.
class ContactVisibility {
 public:
  explicit ContactVisibility(const std::vector<ViewSample>& views) : views_(views) {}

  void add(const Volume& bone, const TickRecord& record, AttemptTick& tick) {
    constexpr double kMaxAge_s = 0.2;
    for (; next_ < views_.size() && views_[next_].time_s <= tick.time_s; ++next_) is_hidden_.reset();
    if (next_ == 0 || !tick.is_cutting() || tick.time_s - views_[next_ - 1].time_s > kMaxAge_s) return;
    if (!is_hidden_) {
      const Vec3 ahead_W = record.burr_force_W_N.stableNormalized();
      is_hidden_ = is_hidden(views_[next_ - 1], bone, tick.burr_W + tick.burr_radius_mm * ahead_W);
    }
    tick.is_contact_hidden = is_hidden_;
  }

 private:
  const std::vector<ViewSample>& views_;
  std::size_t next_ = 0;
  std::optional<bool> is_hidden_;
};

}  // namespace

double Attempt::distance_mm(std::size_t tick) const {
  double least_mm = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t n = 0; n < exercise->structures.size(); ++n)
    least_mm = std::fmin(least_mm, distance_mm(tick, n));
  return least_mm;
}

std::vector<AttemptTick> attempt_ticks(const Recording& recording) {
  std::vector<AttemptTick> ticks;
  ticks.reserve(recording.records.size());
  auto session = recording.sessions.begin();
  double removed_mm3 = 0, radius_mm = recording.description.tool.burr_radius_mm;
  for (std::size_t n = 0; n < recording.records.size(); ++n) {
    for (; session != recording.sessions.end() && session->first <= n; ++session) {
      removed_mm3 = session->start.removed_mm3;
      radius_mm = session->start.run.tool.burr_radius_mm;
    }
    const TickRecord& record = recording.records[n];
    ticks.push_back({.time_s = record.time_s,
                     .dt_s = record.dt_s,
                     .burr_W = record.X_WT.position_mm,
                     .burr_radius_mm = radius_mm,
                     .force_N = record.burr_force_W_N.norm(),
                     .removed_mm3 = std::max(0.0, record.removed_mm3 - removed_mm3),
                     .spindle_on = record.spindle_on,
                     .is_placed = !record.paused && is_finite(record.X_WD)});
    removed_mm3 = record.removed_mm3;
  }
  return ticks;
}

std::vector<std::vector<ThicknessLeft>> thickness_left(const PlacedExercise& exercise, const Volume& before,
                                                       const Volume& after, const VoxelSet& removed) {
  std::vector<std::vector<ThicknessLeft>> left;
  if (exercise.structures.empty()) return left;
  VoxelSet walls(exercise.scan.all_voxels());
  for (const PlacedStructure& structure : exercise.structures)
    structure.voxels.for_each([&](const VoxelIndex& v) { walls.insert(v); });
  const VoxelSet open_before = open_space(before, walls);
  const VoxelSet opened = opened_space(after, open_before, removed, walls);
  for (const PlacedStructure& structure : exercise.structures)
    left.push_back(thickness_over(exercise, structure.voxels, open_before, opened));
  return left;
}

Attempt make_attempt(const PlacedExercise& exercise, const Volume& scan, const Recording& recording) {
  Volume after = scan;
  std::vector<AttemptTick> ticks = attempt_ticks(recording);
  RemovalTimes times(scan);
  ContactVisibility seen(recording.views);
  repeat_milling(after, recording, [&](std::size_t n, const Volume& bone, const VolumeChange& change) {
    WorkProgress::done(n, ticks.size());
    times.add(bone, change.voxels, ticks[n].time_s);
    seen.add(bone, recording.records[n], ticks[n]);
  });
  VoxelSet removed = removed_voxels(scan, after);
  Attempt attempt{&exercise, &scan, std::move(after), std::move(removed), std::move(ticks),
                  {},        {},    times.take(),     recording.views};
  attempt.thickness_left = thickness_left(exercise, scan, attempt.after, attempt.removed);
  attempt.distances_mm.reserve(attempt.ticks.size() * exercise.structures.size());
  for (const AttemptTick& tick : attempt.ticks) {
    for (const auto& [distance, guard_mm] : *exercise.distances) {
      attempt.distances_mm.push_back(tick.is_placed ? distance.from(tick.burr_W) - tick.burr_radius_mm
                                                    : std::numeric_limits<double>::quiet_NaN());
    }
  }
  return attempt;
}

std::vector<AttemptProgress> progress_of(const Attempt& attempt) {
  constexpr std::size_t kTimes = 201, kSteps = kTimes - 1;
  std::vector<AttemptProgress> way;
  if (attempt.ticks.empty()) return way;
  const PlacedExercise& exercise = *attempt.exercise;
  const double begin_s = attempt.ticks.front().time_s, end_s = attempt.ticks.back().time_s;
  std::array<std::size_t, kTimes> target{}, outside{}, all{};
  attempt.removed.for_each([&](const VoxelIndex& v) {
    const double share =
        end_s > begin_s ? (attempt.removed_at_s(v).value_or(begin_s) - begin_s) / (end_s - begin_s) : 1;
    const auto step = static_cast<std::size_t>(std::ceil(std::clamp(share, 0.0, 1.0) * kSteps));
    ++all[step];
    if (exercise.target.contains(v)) ++target[step];
    if (exercise.is_outside(v)) ++outside[step];
  });
  const auto whole = static_cast<double>(exercise.target.count());
  double targets = 0, removed = 0, outsides = 0;
  for (std::size_t step = 0; step < kTimes; ++step) {
    targets += static_cast<double>(target[step]);
    removed += static_cast<double>(all[step]);
    outsides += static_cast<double>(outside[step]);
    way.push_back({begin_s + (end_s - begin_s) * static_cast<double>(step) / kSteps, 100 * targets / whole,
                   outsides * exercise.scan.voxel_volume_mm3(), 200 * targets / (whole + removed)});
  }
  return way;
}

double step_completion_s(const Attempt& attempt, std::size_t step) {
  const VoxelSet& bone = attempt.exercise->steps[step];
  std::vector<double> times_s;
  bone.for_each([&](const VoxelIndex& v) {
    if (const auto time_s = attempt.removed_at_s(v)) times_s.push_back(*time_s);
  });
  const double wanted =
      attempt.exercise->exercise.steps[step].done_percent / 100 * static_cast<double>(bone.count());
  const auto needed = static_cast<std::size_t>(std::ceil(std::max(wanted, 1.0)));
  if (times_s.size() < needed) return std::numeric_limits<double>::quiet_NaN();
  std::ranges::nth_element(times_s, times_s.begin() + static_cast<std::ptrdiff_t>(needed - 1));
  return times_s[needed - 1];
}

bool is_hidden(const ViewSample& view, const Volume& bone, const Vec3& contact_W) {
  const Vec3 contact_C = view.X_WC.inverse() * contact_W;
  const double up = std::tan(0.5 * view.field_of_view_rad);
  const Vec3 seen = contact_C / -contact_C.z();
  if (!(contact_C.z() < 0) || std::abs(seen.y()) > up || std::abs(seen.x()) > up * view.aspect) return true;
  // Ends the line of sight before the contact, which is on bone itself.
  const Vec3& eye_W = view.X_WC.position_mm;
  const double voxel_mm = bone.geometry().spacing_mm.maxCoeff();
  const Vec3 sight_W = (contact_W - eye_W).normalized();
  Vec3 from_W = eye_W;
  const Vec3 to_W = contact_W - 1.5 * voxel_mm * sight_W;
  // The cuts leave a convex part: the line of sight enters it at the last cut.
  for (const ViewClipPlane& cut : view.cuts) {
    if (cut.normal_W.isZero()) continue;
    const double before_mm = cut.offset_mm - cut.normal_W.dot(from_W);
    const double along = cut.normal_W.dot(sight_W);
    if (cut.normal_W.dot(to_W) < cut.offset_mm) return true;
    if (before_mm > 0 && along > 0) from_W += before_mm / along * sight_W;
  }
  return first_crossing(bone, from_W, to_W).has_value();
}

double view_changes(const std::vector<ViewSample>& views) {
  constexpr double kMoved_mm = 0.2, kTurned_rad = 0.01, kRest_s = 0.5;
  if (views.empty()) return std::numeric_limits<double>::quiet_NaN();
  double changes = 0, moved_s = -std::numeric_limits<double>::infinity();
  for (std::size_t n = 1; n < views.size(); ++n) {
    const Pose &before = views[n - 1].X_WC, &now = views[n].X_WC;
    if ((now.position_mm - before.position_mm).norm() < kMoved_mm &&
        now.orientation.angularDistance(before.orientation) < kTurned_rad)
      continue;
    if (views[n].time_s - moved_s > kRest_s) ++changes;
    moved_s = views[n].time_s;
  }
  return changes;
}

std::vector<Stroke> strokes_of(const std::vector<AttemptTick>& ticks) {
  StrokeFinder finder;
  for (const AttemptTick& tick : ticks) finder.add(tick);
  return finder.strokes();
}

}  // namespace osteomill
