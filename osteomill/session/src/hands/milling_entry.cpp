#include "osteomill/session/milling_entry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"
#include "osteomill/volume/sampling.h"

namespace osteomill {

namespace {

constexpr double kFullTurn = 2 * std::numbers::pi;

// A ball that contains the volume, including the interpolated falloff beyond the border voxels.
struct BoundingBall {
  Vec3 centre_W;
  double radius_mm;
};

BoundingBall ball_around(const GridGeometry& geometry) {
  const Vec3 voxels(geometry.dims[0], geometry.dims[1], geometry.dims[2]);
  return {geometry.world_from_voxel(Vec3(0.5 * (voxels - Vec3::Ones()))),
          0.5 * geometry.spacing_mm.cwiseProduct(voxels).norm() + 2 * geometry.spacing_mm.maxCoeff()};
}

// Returns the first bone surface from `from_W` along the direction; if `from_W` is inside bone, the surface
// found going back. Nothing if the line misses the bone.
std::optional<Vec3> surface_along(const Volume& volume, const Vec3& from_W, const Vec3& direction_W) {
  const BoundingBall ball = ball_around(volume.geometry());
  const double middle_mm = direction_W.dot(ball.centre_W - from_W);
  if (!is_bone_at(volume, from_W)) {
    const double last_mm = middle_mm + ball.radius_mm;
    if (!(last_mm > 0)) return std::nullopt;
    return first_crossing(volume, from_W, from_W + last_mm * direction_W);
  }
  // Steps back out of the bone, finely enough to find gaps of one voxel. There is no bone beyond the ball.
  const GridGeometry& geometry = volume.geometry();
  const double step_mm =
      0.5 / (geometry.direction.transpose() * direction_W).cwiseQuotient(geometry.spacing_mm).norm();
  Vec3 inside_W = from_W;
  for (double way_mm = 0; way_mm < 2 * ball.radius_mm + step_mm; way_mm += step_mm) {
    const Vec3 next_W = inside_W - step_mm * direction_W;
    if (!is_bone_at(volume, next_W)) return bisect_crossing(volume, next_W, inside_W);
    inside_W = next_W;
  }
  return std::nullopt;
}

// Returns two unit vectors perpendicular to `direction_W` and to each other.
std::pair<Vec3, Vec3> across(const Vec3& direction_W) {
  Eigen::Index min_axis = 0;
  direction_W.cwiseAbs().minCoeff(&min_axis);
  const Vec3 first_W = direction_W.cross(Vec3::Unit(min_axis)).normalized();
  return {first_W, direction_W.cross(first_W)};
}

// First bone surface along each line of a square lattice perpendicular to the direction.
struct Lattice {
  Vec3 corner_W;
  Vec3 first_W;
  Vec3 second_W;
  double step_mm;
  int side;
  std::vector<std::optional<Vec3>> first_bone_W;

  const std::optional<Vec3>& at(int a, int b) const {
    return first_bone_W[static_cast<std::size_t>(b * side + a)];
  }
};

Lattice sample_along(const Volume& volume, const MillingTool& tool, const Vec3& direction_W) {
  constexpr int kMaxLines = 96;
  const BoundingBall ball = ball_around(volume.geometry());
  Lattice lattice;
  std::tie(lattice.first_W, lattice.second_W) = across(direction_W);
  lattice.step_mm = std::max(tool.burr_radius_mm, 2 * ball.radius_mm / kMaxLines);
  lattice.side = 1 + static_cast<int>(2 * ball.radius_mm / lattice.step_mm);
  lattice.corner_W = ball.centre_W - ball.radius_mm * (direction_W + lattice.first_W + lattice.second_W);
  for (int b = 0; b < lattice.side; ++b) {
    for (int a = 0; a < lattice.side; ++a) {
      const Vec3 from_W = lattice.corner_W + lattice.step_mm * (a * lattice.first_W + b * lattice.second_W);
      lattice.first_bone_W.push_back(surface_along(volume, from_W, direction_W));
    }
  }
  return lattice;
}

// Returns whether the point is in a pit: some bone within 80 mm is more than 4 mm higher, at a slope of more
// than 0.7.
bool is_pit(const Lattice& lattice, int a, int b, const Vec3& direction_W) {
  constexpr double kFar_mm = 80, kHigher_mm = 4, kRise = 0.7;
  const int reach = static_cast<int>(std::ceil(kFar_mm / lattice.step_mm));
  const double here_mm = direction_W.dot(*lattice.at(a, b));
  for (int j = std::max(0, b - reach); j <= std::min(lattice.side - 1, b + reach); ++j) {
    for (int i = std::max(0, a - reach); i <= std::min(lattice.side - 1, a + reach); ++i) {
      const auto& other_W = lattice.at(i, j);
      if (!other_W) continue;
      const double higher_mm = here_mm - direction_W.dot(*other_W);
      if (higher_mm > kHigher_mm && higher_mm > kRise * lattice.step_mm * std::hypot(i - a, j - b))
        return true;
    }
  }
  return false;
}

constexpr double kBefore_mm = 3.0;
// Larger than any distance at which a scan still has bone, mm.
constexpr double kMaxDistance_mm = 1e4;
// Minimum clearance; an algorithm may sense bone that is closer, mm.
constexpr double kClearance_mm = 1.0;

struct Tilt {
  double aside_rad;
  // Counter-clockwise from the right, as seen by the viewer.
  double towards_rad;
};
// First up and to the right, as a right hand holds the tool, then other directions, last straight to the
// viewer.
constexpr std::array kTilts{Tilt{0.9, 1.0}, Tilt{0.9, 2.1}, Tilt{0.9, 0.0}, Tilt{0.9, 3.1}, Tilt{0.9, 4.2},
                            Tilt{0.9, 5.2}, Tilt{0.4, 1.0}, Tilt{0.4, 2.1}, Tilt{0.4, 4.2}, Tilt{0.0, 0.0}};

// Returns whether the border of the volume cuts the bone off at this surface point.
bool is_on_cut_edge(const GridGeometry& geometry, const Vec3& point_W) {
  const Vec3 voxel = geometry.voxel_from_world(point_W);
  const Vec3 last(geometry.dims[0] - 1, geometry.dims[1] - 1, geometry.dims[2] - 1);
  return (voxel.array() < 0).any() || (voxel.array() > last.array()).any();
}

// Returns whether a tool can enter here and stay in bone: it is free above the entry, bone fills at
// least 60 % of the burr's path over the first millimetres, and the path keeps away from the border of the
// volume.
bool can_stay(const Volume& volume, const MillingTool& tool, const MillingEntry& entry) {
  constexpr double kMinBoneShare = 0.6;
  constexpr int kLayers = 6, kLines = 12;
  if (is_on_cut_edge(volume.geometry(), entry.point_W)) return false;
  if (!tool_is_free(volume, tool, pose_above(entry, tool, kStartAbove_mm))) return false;
  const Pose X_WT = pose_above(entry, tool, 0);
  const double depth_mm = std::max(3.0, 2 * tool.burr_radius_mm);
  int bone = 0, all = 0;
  for (int layer = 0; layer < kLayers; ++layer) {
    const Vec3 middle_W = entry.point_W + (layer + 0.5) / kLayers * depth_mm * entry.direction_W;
    for (int n = 0; n < kLines; ++n) {
      const double angle = kFullTurn * n / kLines;
      const Vec3 across_W = X_WT.orientation * Vec3(std::cos(angle), std::sin(angle), 0);
      if (is_on_cut_edge(volume.geometry(), middle_W + 2 * tool.burr_radius_mm * across_W)) return false;
      for (const double radii : {0.3, 0.8}) {
        bone += is_bone_at(volume, middle_W + radii * tool.burr_radius_mm * across_W);
        ++all;
      }
    }
  }
  return bone >= kMinBoneShare * all;
}

// Returns the highest entry, seen against the direction, on a surface that faces the tool and is not a pit,
// at which the tool can stay in bone. Nothing if there is none.
std::optional<MillingEntry> find_entry(const Volume& volume, const MillingTool& tool,
                                       const Vec3& direction_W) {
  constexpr double kMinFacing = 0.7;
  const Lattice lattice = sample_along(volume, tool, direction_W);
  std::vector<std::pair<double, std::pair<int, int>>> places;
  for (int b = 0; b < lattice.side; ++b) {
    for (int a = 0; a < lattice.side; ++a) {
      if (const auto& first_bone_W = lattice.at(a, b))
        places.push_back({direction_W.dot(*first_bone_W), {a, b}});
    }
  }
  std::sort(places.begin(), places.end());
  for (const auto& [depth_mm, place] : places) {
    const Vec3& point_W = *lattice.at(place.first, place.second);
    const auto outward_W = outward_normal(volume, point_W);
    if (!outward_W || outward_W->dot(-direction_W) < kMinFacing) continue;
    if (is_pit(lattice, place.first, place.second, direction_W)) continue;
    const MillingEntry entry{point_W, direction_W};
    if (can_stay(volume, tool, entry)) return entry;
  }
  return std::nullopt;
}

// Slightly more than 4 mm, so that a voxel layer at exactly that depth is included despite rounding.
constexpr double kTop_mm = 4.0 + 1e-6;
constexpr int kSides = 36;

Vec3 unit_direction(const std::optional<Vec3>& direction) {
  if (!direction) return -Vec3::UnitZ();
  const double length = direction->norm();
  if (!std::isfinite(length)) throw InputError("direction", "its numbers must be finite");
  if (!(length > 0)) throw InputError("direction", "must not be 0,0,0");
  return *direction / length;
}

struct BoneTop {
  Vec3 highest_W = Vec3::Zero();
  // Centroid of all bone near the top, projected to the top's height, in W.
  Vec3 middle_W = Vec3::Zero();
};

InputError no_bone(const Volume& volume, std::string_view scan) {
  float greatest = volume.grid().outside_density();
  for_each_density(volume.grid(), [&](float density) { greatest = std::max(greatest, density); });
  return {scan, fmt::format("has no bone to mill: no voxel is denser than the isovalue, {:.6g}, and the "
                            "densest has {:.6g}",
                            volume.isovalue(), greatest)};
}

BoneTop top_of_bone(const Volume& volume, const Vec3& direction_W, std::string_view scan) {
  double min_depth_mm = std::numeric_limits<double>::infinity();
  BoneTop top;
  for_each_bone_voxel(volume, [&](const VoxelIndex& v) {
    const Vec3 p = volume.geometry().world_from_voxel(v);
    const double depth_mm = direction_W.dot(p);
    if (depth_mm < min_depth_mm) {
      min_depth_mm = depth_mm;
      top.highest_W = p;
    }
  });
  if (!std::isfinite(min_depth_mm)) throw no_bone(volume, scan);
  Vec3 sum_mm = Vec3::Zero();
  double count = 0;
  for_each_bone_voxel(volume, [&](const VoxelIndex& v) {
    const Vec3 p = volume.geometry().world_from_voxel(v);
    if (direction_W.dot(p) > min_depth_mm + kTop_mm) return;
    sum_mm += p - top.highest_W;
    count += 1;
  });
  const Vec3 offset_mm = sum_mm / count;
  top.middle_W = top.highest_W + offset_mm - direction_W.dot(offset_mm) * direction_W;
  return top;
}

// Returns the mean height above the entry of the future hole's rim on one side; -10 mm for samples without
// bone.
double rim_height_mm(const Volume& volume, const MillingTool& tool, const MillingEntry& entry,
                     const Vec3& side_W) {
  constexpr double kAbove_mm = 10.0;
  constexpr double kBelow_mm = 10.0;
  double sum_mm = 0;
  for (double radii : {1.0, 1.5, 2.0}) {
    const Vec3 base_W = entry.point_W + radii * tool.burr_radius_mm * side_W;
    const Vec3 from_W = base_W - kAbove_mm * entry.direction_W;
    const auto first_bone_W = first_crossing(volume, from_W, base_W + kBelow_mm * entry.direction_W);
    sum_mm += first_bone_W ? kAbove_mm - entry.direction_W.dot(*first_bone_W - from_W) : -kBelow_mm;
  }
  return sum_mm / 3;
}

Vec3 towards_highest_rim(const Volume& volume, const MillingTool& tool, const MillingEntry& entry) {
  // Minimum height advantage, above the numerical noise of a crossing, so that flat bone always gives the
  // same side.
  constexpr double kHigher_mm = 1e-3;
  const auto [first_W, second_W] = across(entry.direction_W);
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
  const MillingEntry entry{*point_W, direction_W};
  if (!tool_is_free(volume, tool, pose_above(entry, tool, kStartAbove_mm))) {
    throw InputError("entry", "bone is in the way of the tool above it; another direction may be free");
  }
  return entry;
}

MillingEntry top_entry(const Volume& volume, const MillingTool& tool, const BoneTop& top,
                       const Vec3& direction_W) {
  MillingEntry entry;
  entry.direction_W = direction_W;
  const double above_mm = 2 * volume.geometry().spacing_mm.maxCoeff();
  const auto point_W = surface_along(volume, top.middle_W - above_mm * direction_W, direction_W);
  if (point_W) {
    entry.point_W = *point_W;
    if (tool_is_free(volume, tool, pose_above(entry, tool, kStartAbove_mm))) return entry;
  }
  // The centre of a bone voxel is inside the bone; the surface is the crossing above it.
  entry.point_W = surface_along(volume, top.highest_W, direction_W).value_or(top.highest_W);
  return entry;
}

// Returns the top if the tool can stay in bone there, otherwise the highest entry at which it can, also from
// other directions if none was given. Falls back to the top.
MillingEntry default_entry(const Volume& volume, const MillingTool& tool, const BoneTop& top,
                           const Vec3& direction_W, bool given_direction) {
  const MillingEntry at_top = top_entry(volume, tool, top, direction_W);
  // An entry far below the highest voxel is in a hollow inside a rim that the volume's border cuts off.
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

Pose free_pose_before(const Volume& volume, const MillingTool& tool, const Vec3& point_W,
                      const Vec3& towards_viewer_W, const Vec3& up_W) {
  const Vec3 right_W = up_W.cross(towards_viewer_W);
  const double room_mm = std::max(kClearance_mm, 2 * volume.geometry().spacing_mm.maxCoeff());
  MillingTool with_room = tool;
  with_room.burr_radius_mm += room_mm;
  with_room.shaft_radius_mm += room_mm;
  Pose X_WT;
  for (double before_mm = std::max(kBefore_mm, 1.5 * room_mm); before_mm < kMaxDistance_mm;
       before_mm *= 1.5) {
    X_WT.position_mm = point_W + (tool.burr_radius_mm + before_mm) * towards_viewer_W;
    for (const Tilt& tilt : kTilts) {
      const Vec3 aside_W = std::cos(tilt.towards_rad) * right_W + std::sin(tilt.towards_rad) * up_W;
      const Vec3 shaft_W = std::cos(tilt.aside_rad) * towards_viewer_W + std::sin(tilt.aside_rad) * aside_W;
      X_WT.orientation = smallest_rotation(Vec3::UnitZ(), shaft_W);
      if (tool_is_free(volume, with_room, X_WT)) return X_WT;
    }
  }
  return X_WT;
}

std::vector<std::string> coarseness_warnings(const GridGeometry& geometry, const MillingTool& tool) {
  const double apart_mm = geometry.spacing_mm.maxCoeff();
  if (apart_mm <= tool.burr_radius_mm) return {};
  return {fmt::format(
      "the scan's voxels lie up to {:.3g} mm apart, more than the burr's radius of {:.3g} mm: milling is "
      "hardly visible or felt",
      apart_mm, tool.burr_radius_mm)};
}

std::vector<std::string> entry_warnings(const Volume& volume, const MillingTool& tool,
                                        const MillingEntry& entry) {
  std::vector<std::string> warnings = coarseness_warnings(volume.geometry(), tool);
  if (is_on_cut_edge(volume.geometry(), entry.point_W)) {
    warnings.emplace_back("the tool enters where the border of the volume cuts the bone off");
  } else if (!can_stay(volume, tool, entry)) {
    warnings.emplace_back("the tool leaves the bone again soon after it has entered");
  }
  return warnings;
}

Pose pose_above(const MillingEntry& entry, const MillingTool& tool, double above_mm) {
  return {entry.point_W - (tool.burr_radius_mm + above_mm) * entry.direction_W,
          smallest_rotation(Vec3::UnitZ(), -entry.direction_W)};
}

MillingEntry place_entry(const Volume& volume, const MillingTool& tool, const std::optional<Vec3>& entry,
                         const std::optional<Vec3>& direction, std::string_view scan) {
  require_valid(tool);
  const Vec3 direction_W = unit_direction(direction);
  const BoneTop top = top_of_bone(volume, direction_W, scan);
  MillingEntry placed = entry ? given_entry(volume, tool, *entry, direction_W)
                              : default_entry(volume, tool, top, direction_W, direction.has_value());
  placed.lateral_W = towards_highest_rim(volume, tool, placed);
  return placed;
}

}  // namespace osteomill
