#include "crown.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "osteomill/volume/sampling.h"

namespace osteomill {

namespace {

// Search depth below the original surface, and search height for bone above an undercut.
constexpr double kReach_mm = 6;

// Measures the crown along the normal at a point of its original surface.
void measure_at(const Attempt& attempt, const Vec3& axis_W, const Vec3& place_W, Crown& crown) {
  constexpr double kReduced_mm = 0.3, kAxial_deg = 30;
  const auto outward_W = outward_normal(*attempt.scan, place_W);
  if (!outward_W) return;
  const Vec3 from_W = place_W + *outward_W, to_W = place_W - kReach_mm * *outward_W;
  const auto before_W = first_crossing(*attempt.scan, from_W, to_W);
  const auto after_W = first_crossing(attempt.after, from_W, to_W);
  if (!before_W || !after_W) return;
  const double reduced_mm = (*before_W - *after_W).dot(*outward_W);
  crown.reductions_mm.push_back(std::max(0.0, reduced_mm));
  const auto wall_W = outward_normal(attempt.after, *after_W);
  if (reduced_mm < kReduced_mm || !wall_W) return;
  const double angle_deg = std::asin(std::clamp(wall_W->dot(axis_W), -1.0, 1.0)) * 180 / std::numbers::pi;
  if (std::abs(angle_deg) < kAxial_deg) crown.wall_angles_deg.push_back(angle_deg);
}

bool is_under_bone(const Attempt& attempt, const Vec3& axis_W, const Vec3& place_W) {
  const double step_mm = attempt.exercise->scan.spacing_mm.minCoeff();
  return first_crossing(attempt.after, place_W + step_mm * axis_W, place_W + kReach_mm * axis_W).has_value();
}

}  // namespace

Crown crown_of(const Attempt& attempt) {
  Crown crown;
  const PlacedExercise& exercise = *attempt.exercise;
  if (!exercise.exercise.crown_axis_W) return crown;
  const Vec3& axis_W = *exercise.exercise.crown_axis_W;
  std::size_t undercut = 0;
  exercise.target.for_each([&](const VoxelIndex& v) {
    const Vec3 place_W = exercise.scan.world_from_voxel(v);
    bool is_outer = false;
    for (const int step : {-1, 1}) {
      for (const VoxelIndex& beside : {VoxelIndex{v.i + step, v.j, v.k}, VoxelIndex{v.i, v.j + step, v.k},
                                       VoxelIndex{v.i, v.j, v.k + step}})
        is_outer = is_outer || !attempt.scan->is_bone_in_grid(beside);
    }
    if (is_outer) measure_at(attempt, axis_W, place_W, crown);
    if (attempt.removed.contains(v) && is_under_bone(attempt, axis_W, place_W)) ++undercut;
  });
  crown.undercut_mm3 = exercise.volume_mm3(undercut);
  return crown;
}

}  // namespace osteomill
