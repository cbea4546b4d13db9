#include "osteomill/operator/milling_entry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "osteomill/files/input_error.h"
#include "osteomill/numbers/work_progress.h"
#include "osteomill/operator/entry_places.h"
#include "osteomill/volume/sampling.h"

namespace osteomill {

namespace {

// A little more than 4 mm: a layer of voxels at just that depth counts whichever way its last bit falls.
constexpr double kTop_mm = 4.0 + 1e-6;
constexpr int kSides = 36;
constexpr double kFullTurn = 2 * std::numbers::pi;

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

// The top, where the tool can stay in bone there, else the highest place where it can, else seen from another
// side, unless a direction was asked for; and if there is none the top all the same.
MillingEntry default_entry(const Volume& volume, const MillingTool& tool, const Top& top,
                           const Vec3& direction_W, bool given_direction) {
  const MillingEntry at_top = top_entry(volume, tool, top, direction_W);
  // In the middle of a rim that the volume cuts off is a hollow.
  const double below_mm = direction_W.dot(at_top.point_W - top.highest_W);
  if (below_mm < 2 * kTop_mm && can_stay(volume, tool, at_top)) return at_top;
  std::vector<Vec3> directions{direction_W};
  if (!given_direction) {
    for (const Vec3& side : {Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 0, 1)})
      directions.push_back(side);
  }
  for (const Vec3& direction : directions) {
    if (const auto found = find_entry(volume, tool, direction)) return *found;
  }
  return at_top;
}

}  // namespace

std::vector<std::string> entry_warnings(const Volume& volume, const MillingTool& tool,
                                        const MillingEntry& entry) {
  std::vector<std::string> warnings;
  const double apart_mm = volume.geometry().spacing_mm.maxCoeff();
  if (apart_mm > tool.burr_radius_mm) {
    warnings.push_back(fmt::format(
        "the scan's voxels lie up to {:.3g} mm apart, more than the burr's radius of {:.3g} mm: what is "
        "milled is hardly seen or felt as it was",
        apart_mm, tool.burr_radius_mm));
  }
  if (is_on_cut_edge(volume.geometry(), entry.point_W)) {
    warnings.emplace_back("the tool enters where the border of the volume cuts the bone off");
  } else if (!can_stay(volume, tool, entry)) {
    warnings.emplace_back("where the tool enters it does not stay in bone for long");
  }
  return warnings;
}

Pose pose_above(const MillingEntry& entry, const MillingTool& tool, double above_mm) {
  return {entry.point_W - (tool.burr_radius_mm + above_mm) * entry.direction_W,
          smallest_rotation(Vec3::UnitZ(), -entry.direction_W)};
}

MillingEntry place_entry(const Volume& volume, const MillingTool& tool, const std::optional<Vec3>& entry,
                         const std::optional<Vec3>& direction) {
  require_valid(tool);
  const Vec3 direction_W = unit_direction(direction);
  const Top top = top_of_bone(volume, direction_W);
  MillingEntry placed = entry ? given_entry(volume, tool, *entry, direction_W)
                              : default_entry(volume, tool, top, direction_W, direction.has_value());
  placed.lateral_W = towards_highest_rim(volume, tool, placed);
  return placed;
}

}  // namespace osteomill
