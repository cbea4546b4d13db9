#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/haptics/milling_tool.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// The height of the burr's surface above the bone when a script begins.
inline constexpr double kStartAbove_mm = 3.0;

/// The place and the direction in which the tool enters the bone.
struct MillingEntry {
  /// On the surface of the bone.
  Vec3 point_W = Vec3::Zero();
  /// Unit, into the bone; the shaft points against it.
  Vec3 direction_W = -Vec3::UnitZ();
  /// Unit, across the direction: towards the highest rim, against which the shaft is leant.
  Vec3 lateral_W = Vec3::UnitX();
};

/// Chooses where to enter the bone. `direction` (any length) is -z of W if it is not given.
///
/// If `entry` is given, the place is the first bone met from there along the direction, or, if `entry` lies
/// in bone, the point at which the way back leaves it. If not, it is the top of the bone, where the direction
/// meets it first: the middle of all bone within 4 mm of its highest voxel, and from above it the first bone
/// along the direction. If there is none (the middle of a ring), or the tool does not fit above it, it is the
/// highest voxel itself. If a tool could not enter there and stay in bone (the volume cuts it off, or it is a
/// thin edge), it is the highest place where it could; and if no direction was given either, seen from
/// another side if need be.
///
/// Throws InputError: no bone in the scan, which the message calls `scan`; an entry or direction that is not
/// finite, a direction without length; a line from a given entry that misses the bone; bone in the way of the
/// tool above a given entry. Not for the tick: it goes through every voxel.
MillingEntry place_entry(const Volume& volume, const MillingTool& tool,
                         const std::optional<Vec3>& entry = std::nullopt,
                         const std::optional<Vec3>& direction = std::nullopt, std::string_view scan = "scan");

/// Returns a sentence if the scan is too coarse for the burr, as it is if its slices lie further apart than
/// the burr's radius.
std::vector<std::string> coarseness_warnings(const GridGeometry& geometry, const MillingTool& tool);

/// Returns what a user should know about this place, a sentence each: `coarseness_warnings`, that the border
/// of the volume cuts the bone off there, or that the tool does not stay in bone.
std::vector<std::string> entry_warnings(const Volume& volume, const MillingTool& tool,
                                        const MillingEntry& entry);

/// Returns the pose of the tool with its shaft against the entry's direction, its burr's surface `above_mm`
/// above the entry.
Pose pose_above(const MillingEntry& entry, const MillingTool& tool, double above_mm);

/// Returns whether no bone lies in the tool at this pose, by lines along the shaft and from the burr's centre
/// to its surface.
bool tool_is_free(const Volume& volume, const MillingTool& tool, const Pose& X_WT);

/// Returns a pose of the tool free of bone, before a point of the bone as seen by a viewer who looks against
/// `towards_viewer_W` with `up_W` up (both unit, at a right angle): the burr's surface 3 mm before the point,
/// or as much further towards the viewer as it takes, and the shaft towards the viewer, tilted upwards and
/// aside as far as bone lets it, so that it does not hide the burr. Bone is a millimetre away at least. Not
/// for the tick.
Pose free_pose_before(const Volume& volume, const MillingTool& tool, const Vec3& point_W,
                      const Vec3& towards_viewer_W, const Vec3& up_W);

}  // namespace osteomill
