#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/haptics/milling_tool.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Height of the burr's surface above the bone at the start of a script.
inline constexpr double kStartAbove_mm = 3.0;

/// Point and direction at which the tool enters the bone.
struct MillingEntry {
  /// On the surface of the bone.
  Vec3 point_W = Vec3::Zero();
  /// Unit vector into the bone; the shaft points the opposite way.
  Vec3 direction_W = -Vec3::UnitZ();
  /// Unit vector perpendicular to `direction_W`, towards the highest rim, against which the shaft is leant.
  Vec3 lateral_W = Vec3::UnitX();
};

/// Chooses where to enter the bone. `direction` may have any length; the default is -z of W.
///
/// If `entry` is given, the point is the first bone surface from there along the direction; if `entry` is
/// inside bone, the surface found going back against the direction. Otherwise it is the top of the bone, seen
/// against the direction: the first bone along the direction above the centroid of all bone within 4 mm of
/// the highest voxel. If there is no bone below the centroid (a ring) or the tool does not fit above it, it
/// is the highest voxel. If the tool could not stay in bone there (the border of the volume cuts the bone
/// off, or it is a thin edge), it is the highest point at which it can, trying other directions as well if
/// none was given.
///
/// Throws InputError if the scan (called `scan` in the message) has no bone, `entry` or `direction` is not
/// finite, `direction` is zero, the line from a given entry misses the bone, or bone blocks the tool above a
/// given entry. Reads every voxel; not for the haptic tick.
MillingEntry place_entry(const Volume& volume, const MillingTool& tool,
                         const std::optional<Vec3>& entry = std::nullopt,
                         const std::optional<Vec3>& direction = std::nullopt, std::string_view scan = "scan");

/// Returns a sentence if the scan is too coarse for the burr (largest voxel spacing above the burr's radius).
std::vector<std::string> coarseness_warnings(const GridGeometry& geometry, const MillingTool& tool);

/// Returns warnings about this entry, one sentence each: `coarseness_warnings`, and that the border of the
/// volume cuts the bone off there or that the tool does not stay in bone.
std::vector<std::string> entry_warnings(const Volume& volume, const MillingTool& tool,
                                        const MillingEntry& entry);

/// Returns the tool pose with the shaft opposite to the entry's direction and the burr's surface `above_mm`
/// above the entry.
Pose pose_above(const MillingEntry& entry, const MillingTool& tool, double above_mm);

/// Returns whether the tool is free of bone at this pose. Tests line segments along the shaft and from the
/// burr's centre to its surface.
bool tool_is_free(const Volume& volume, const MillingTool& tool, const Pose& X_WT);

/// Returns a tool pose free of bone in front of `point_W`, as seen by a viewer. `towards_viewer_W` and `up_W`
/// are perpendicular unit vectors. The burr's surface is 3 mm in front of the point, or farther if bone is in
/// the way. The shaft points towards the viewer, tilted up and sideways as far as bone allows so that it does
/// not hide the burr. The clearance to bone is at least 1 mm. Not for the haptic tick.
Pose free_pose_before(const Volume& volume, const MillingTool& tool, const Vec3& point_W,
                      const Vec3& towards_viewer_W, const Vec3& up_W);

}  // namespace osteomill
