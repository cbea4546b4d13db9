#include "osteomill/operator/milling_entry.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "osteomill/files/input_error.h"
#include "osteomill/numbers/work_progress.h"
#include "osteomill/volume/isosurface.h"

namespace osteomill {

namespace {

// A little more than 4 mm: a layer of voxels at just that depth counts whichever way its last bit falls.
constexpr double kTop_mm = 4.0 + 1e-6;
constexpr int kSides = 36;
constexpr double kFullTurn = 6.283185307179586;

template <typename Visit>
void for_each_bone_voxel(const Volume& volume, const Visit& visit) {
  const auto& dims = volume.geometry().dims;
  for (int k = 0; k < dims[2]; ++k) {
    WorkProgress::done(static_cast<std::size_t>(k), static_cast<std::size_t>(dims[2]));
    for (int j = 0; j < dims[1]; ++j) {
      for (int i = 0; i < dims[0]; ++i) {
        const VoxelIndex v{i, j, k};
        if (volume.is_bone(v)) visit(volume.geometry().world_from_voxel(v));
      }
    }
  }
}

// A ball that holds all densities, also those that fall off beyond the border voxels.
struct BoundingBall {
  Vec3 centre_W;
  double radius_mm;
};

BoundingBall ball_around(const GridGeometry& geometry) {
  const Vec3 voxels(geometry.dims[0], geometry.dims[1], geometry.dims[2]);
  return {geometry.world_from_voxel(Vec3(0.5 * (voxels - Vec3::Ones()))),
          0.5 * geometry.spacing_mm.cwiseProduct(voxels).norm() + 2 * geometry.spacing_mm.maxCoeff()};
}

Vec3 unit_direction(const std::optional<Vec3>& direction) {
  if (!direction) return -Vec3::UnitZ();
  const double length = direction->norm();
  if (!std::isfinite(length)) throw InputError("direction", "its numbers must be finite");
  if (!(length > 0)) throw InputError("direction", "0,0,0 points nowhere");
  return *direction / length;
}

struct Top {
  Vec3 highest_W = Vec3::Zero();
  // Of all bone near the top, in W; its height is the top's.
  Vec3 middle_W = Vec3::Zero();
};

Top top_of_bone(const Volume& volume, const Vec3& direction_W) {
  double min_depth_mm = std::numeric_limits<double>::infinity();
  Top top;
  for_each_bone_voxel(volume, [&](const Vec3& p) {
    const double depth_mm = direction_W.dot(p);
    if (depth_mm < min_depth_mm) {
      min_depth_mm = depth_mm;
      top.highest_W = p;
    }
  });
  if (!std::isfinite(min_depth_mm)) {
    throw InputError("scan", "no voxel is denser than the isovalue, so there is no bone to mill");
  }
  Vec3 sum_mm = Vec3::Zero();
  double count = 0;
  for_each_bone_voxel(volume, [&](const Vec3& p) {
    if (direction_W.dot(p) > min_depth_mm + kTop_mm) return;
    sum_mm += p - top.highest_W;
    count += 1;
  });
  const Vec3 offset_mm = sum_mm / count;
  top.middle_W = top.highest_W + offset_mm - direction_W.dot(offset_mm) * direction_W;
  return top;
}

std::optional<Vec3> surface_along(const Volume& volume, const Vec3& from_W, const Vec3& direction_W) {
  const BoundingBall ball = ball_around(volume.geometry());
  const double middle_mm = direction_W.dot(ball.centre_W - from_W);
  if (!is_bone_at(volume, from_W)) {
    // Only the part of the line near the grid is walked, however far away it begins.
    const double first_mm = std::max(0.0, middle_mm - ball.radius_mm);
    const double last_mm = middle_mm + ball.radius_mm;
    if (!(last_mm > first_mm)) return std::nullopt;
    return first_crossing(volume, from_W + first_mm * direction_W, from_W + last_mm * direction_W);
  }
  // Back out of the bone in steps that miss no gap of a voxel; beyond the ball there is none.
  const double step_mm = 0.5 * volume.geometry().spacing_mm.minCoeff();
  Vec3 inside_W = from_W;
  for (double way_mm = 0; way_mm < 2 * ball.radius_mm + step_mm; way_mm += step_mm) {
    const Vec3 next_W = inside_W - step_mm * direction_W;
    if (!is_bone_at(volume, next_W)) return bisect_crossing(volume, next_W, inside_W);
    inside_W = next_W;
  }
  return std::nullopt;
}

// Whether no bone lies in the tool, by lines along the shaft and from the burr's centre to its surface.
bool tool_is_free(const Volume& volume, const MillingTool& tool, const Pose& X_WT) {
  const auto free_between = [&](const Vec3& from_T, const Vec3& to_T) {
    return !first_crossing(volume, X_WT * from_T, X_WT * to_T);
  };
  const Vec3 end = tool.shaft_length_mm * Vec3::UnitZ();
  if (!free_between(-tool.burr_radius_mm * Vec3::UnitZ(), end)) return false;
  constexpr int kLines = 12;
  for (int n = 0; n < kLines; ++n) {
    const double angle = kFullTurn * n / kLines;
    const Vec3 across(std::cos(angle), std::sin(angle), 0);
    if (!free_between(tool.shaft_radius_mm * across, tool.shaft_radius_mm * across + end)) return false;
    for (double slope : {-2.0, -1.0, -0.5, 0.0, 1.0}) {
      const Vec3 to_surface = tool.burr_radius_mm * (across + slope * Vec3::UnitZ()).normalized();
      if (!free_between(Vec3::Zero(), to_surface)) return false;
    }
  }
  return true;
}

// How high the rim of the hole to come stands on one side, above the entry; a side without bone is far below.
double rim_height_mm(const Volume& volume, const MillingTool& tool, const MillingEntry& entry,
                     const Vec3& side_W) {
  constexpr double kAbove_mm = 10.0;
  constexpr double kBelow_mm = 10.0;
  double sum_mm = 0;
  for (double radii : {1.0, 1.5, 2.0}) {
    const Vec3 base_W = entry.point_W + radii * tool.burr_radius_mm * side_W;
    const Vec3 from_W = base_W - kAbove_mm * entry.direction_W;
    const auto met_W = first_crossing(volume, from_W, base_W + kBelow_mm * entry.direction_W);
    sum_mm += met_W ? kAbove_mm - entry.direction_W.dot(*met_W - from_W) : -kBelow_mm;
  }
  return sum_mm / 3;
}

Vec3 towards_highest_rim(const Volume& volume, const MillingTool& tool, const MillingEntry& entry) {
  // A side must be higher by more than the noise of a crossing, so that flat bone gives the same side
  // everywhere.
  constexpr double kHigher_mm = 1e-3;
  Eigen::Index min_axis = 0;
  entry.direction_W.cwiseAbs().minCoeff(&min_axis);
  const Vec3 first_W = entry.direction_W.cross(Vec3::Unit(min_axis)).normalized();
  const Vec3 second_W = entry.direction_W.cross(first_W);
  Vec3 best_W = first_W;
  double best_mm = -std::numeric_limits<double>::infinity();
  for (int n = 0; n < kSides; ++n) {
    const double angle = kFullTurn * n / kSides;
    const Vec3 side_W = (std::cos(angle) * first_W + std::sin(angle) * second_W).normalized();
    const double height_mm = rim_height_mm(volume, tool, entry, side_W);
    if (height_mm > best_mm + kHigher_mm) {
      best_mm = height_mm;
      best_W = side_W;
    }
  }
  return best_W;
}

MillingEntry given_entry(const Volume& volume, const MillingTool& tool, const Vec3& entry_W,
                         const Vec3& direction_W) {
  if (!entry_W.allFinite()) throw InputError("entry", "its numbers must be finite");
  const auto point_W = surface_along(volume, entry_W, direction_W);
  if (!point_W) throw InputError("entry", "the line from it along the direction meets no bone");
  MillingEntry entry;
  entry.point_W = *point_W;
  entry.direction_W = direction_W;
  if (!tool_is_free(volume, tool, pose_above(entry, tool, kStartAbove_mm))) {
    throw InputError("entry", "bone is in the way of the tool above it; another direction may be free");
  }
  return entry;
}

MillingEntry top_entry(const Volume& volume, const MillingTool& tool, const Top& top,
                       const Vec3& direction_W) {
  MillingEntry entry;
  entry.direction_W = direction_W;
  const double above_mm = 2 * volume.geometry().spacing_mm.maxCoeff();
  const auto point_W = surface_along(volume, top.middle_W - above_mm * direction_W, direction_W);
  if (point_W) {
    entry.point_W = *point_W;
    if (tool_is_free(volume, tool, pose_above(entry, tool, kStartAbove_mm))) return entry;
  }
  // A voxel's centre lies in the bone; its surface is the crossing above it.
  entry.point_W = surface_along(volume, top.highest_W, direction_W).value_or(top.highest_W);
  return entry;
}

}  // namespace

Pose pose_above(const MillingEntry& entry, const MillingTool& tool, double above_mm) {
  return {entry.point_W - (tool.burr_radius_mm + above_mm) * entry.direction_W,
          smallest_rotation(Vec3::UnitZ(), -entry.direction_W)};
}

MillingEntry place_entry(const Volume& volume, const MillingTool& tool, const std::optional<Vec3>& entry,
                         const std::optional<Vec3>& direction) {
  require_valid(tool);
  const Vec3 direction_W = unit_direction(direction);
  const Top top = top_of_bone(volume, direction_W);
  MillingEntry placed =
      entry ? given_entry(volume, tool, *entry, direction_W) : top_entry(volume, tool, top, direction_W);
  placed.lateral_W = towards_highest_rim(volume, tool, placed);
  return placed;
}

}  // namespace osteomill
