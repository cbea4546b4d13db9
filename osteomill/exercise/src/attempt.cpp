#include "osteomill/exercise/attempt.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "osteomill/exercise/nearest_voxels.h"
#include "osteomill/exercise/region_voxels.h"
#include "osteomill/recording/replay_recording.h"

namespace osteomill {

namespace {

// Follows the burr's path through the ticks in which it cuts.
class StrokeFinder {
 public:
  void add(const AttemptTick& tick) {
    if (!tick.is_cutting()) {
      pause_s_ += tick.dt_s;
      if (pause_s_ >= kPause_s) end();
      return;
    }
    if (!begun_) begin_at(tick.burr_W);
    // A short time without cutting belongs to the stroke.
    current_.duration_s += std::exchange(pause_s_, 0) + tick.dt_s;
    const Vec3 step = tick.burr_W - corner_;
    beyond_mm_ = std::max(beyond_mm_, step.dot(direction_));
    if (step.norm() < kStep_mm) return;
    if (step.dot(direction_) < 0) {
      // The path turned between its last corner and here, where it had come farthest.
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
  // The direction of the last step, zero in a stroke's first, and how far the path went on along it since.
  Vec3 direction_ = Vec3::Zero();
  double beyond_mm_ = 0;
  double pause_s_ = 0;
  bool begun_ = false;
};

// Returns the bone left over a structure, given the space that is open from outside before and after.
std::vector<double> thickness_over(const PlacedExercise& exercise, const VoxelSet& structure,
                                   const VoxelSet& open_before, const VoxelSet& open_after) {
  const Vec3& spacing_mm = exercise.scan.spacing_mm;
  constexpr double kReach_mm = 8;
  const auto reach = static_cast<int>(std::ceil(kReach_mm / spacing_mm.minCoeff()));
  const VoxelBox box = structure.box().grown(reach).intersected(exercise.scan.all_voxels());
  // Space that is open when the exercise begins is no work of the trainee's.
  const NearestVoxels before(open_before, box, spacing_mm), after(open_after, box, spacing_mm);
  const double voxel_mm = spacing_mm.minCoeff();
  std::vector<double> left_mm;
  structure.for_each([&](const VoxelIndex& v) {
    const double now_mm = after.distance_mm(v);
    if (!(now_mm <= kReach_mm) || now_mm > before.distance_mm(v) - voxel_mm) return;
    // A voxel within the structure lies behind its surface.
    const VoxelIndex open = after.nearest_to(v);
    const Vec3 way(open.i - v.i, open.j - v.j, open.k - v.k);
    const Vec3 next = (Vec3(v.i, v.j, v.k) + way / way.cwiseAbs().maxCoeff()).array().round();
    const VoxelIndex beside{static_cast<int>(next.x()), static_cast<int>(next.y()),
                            static_cast<int>(next.z())};
    if (!structure.contains(beside)) left_mm.push_back(std::max(0.0, now_mm - voxel_mm));
  });
  return left_mm;
}

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

std::vector<std::vector<double>> thickness_left_mm(const PlacedExercise& exercise, const Volume& before,
                                                   const Volume& after) {
  std::vector<std::vector<double>> left_mm;
  if (exercise.structures.empty()) return left_mm;
  VoxelSet walls(exercise.scan.all_voxels());
  for (const PlacedStructure& structure : exercise.structures)
    structure.voxels.for_each([&](const VoxelIndex& v) { walls.insert(v); });
  const VoxelSet open_before = open_space(before, walls), open_after = open_space(after, walls);
  for (const PlacedStructure& structure : exercise.structures)
    left_mm.push_back(thickness_over(exercise, structure.voxels, open_before, open_after));
  return left_mm;
}

Attempt make_attempt(const PlacedExercise& exercise, const Volume& scan, const Recording& recording) {
  Volume after = scan;
  repeat_milling(after, recording);
  VoxelSet removed = removed_voxels(scan, after);
  Attempt attempt{&exercise, &scan, std::move(after), std::move(removed), attempt_ticks(recording), {}, {}};
  attempt.thickness_left_mm = thickness_left_mm(exercise, scan, attempt.after);
  attempt.distances_mm.reserve(attempt.ticks.size() * exercise.structures.size());
  for (const AttemptTick& tick : attempt.ticks) {
    for (const PlacedStructure& structure : exercise.structures) {
      attempt.distances_mm.push_back(tick.is_placed
                                         ? structure.distance.from(tick.burr_W) - tick.burr_radius_mm
                                         : std::numeric_limits<double>::quiet_NaN());
    }
  }
  return attempt;
}

std::vector<Stroke> strokes_of(const std::vector<AttemptTick>& ticks) {
  StrokeFinder finder;
  for (const AttemptTick& tick : ticks) finder.add(tick);
  return finder.strokes();
}

}  // namespace osteomill
