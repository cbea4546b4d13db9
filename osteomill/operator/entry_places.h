#pragma once

#include <optional>

#include "osteomill/operator/milling_entry.h"

namespace osteomill {

/// The first bone from `from_W` along the direction, or, where `from_W` lies in bone, the point at which the
/// way back leaves it. Nothing where the line meets none.
std::optional<Vec3> surface_along(const Volume& volume, const Vec3& from_W, const Vec3& direction_W);

/// Whether no bone lies in the tool at this pose, by lines along the shaft and from the burr's centre to its
/// surface.
bool tool_is_free(const Volume& volume, const MillingTool& tool, const Pose& X_WT);

/// Whether bone is cut off here by the border of the volume.
bool is_on_cut_edge(const GridGeometry& geometry, const Vec3& point_W);

/// Whether a tool can enter here and stay in bone: it is free above; bone fills most of where the burr goes
/// in the first millimetres; and it does not come near the border of the volume meanwhile.
bool can_stay(const Volume& volume, const MillingTool& tool, const MillingEntry& entry);

/// The highest place, seen against the direction, at which a tool can enter a face that looks at it and stay,
/// and which is no pit. Nothing where there is none.
std::optional<MillingEntry> find_entry(const Volume& volume, const MillingTool& tool,
                                       const Vec3& direction_W);

/// A pose of the tool free of bone, before a point of it as someone sees it who looks against
/// `towards_viewer_W` with `up_W` up (both unit, at a right angle): the burr's surface 3 mm before the point,
/// or as much further towards the viewer as it takes, and the shaft towards the viewer, tilted upwards and
/// aside as far as bone lets it, so that it does not hide the burr. Bone is a millimetre away at least. Not
/// for the tick.
Pose free_pose_before(const Volume& volume, const MillingTool& tool, const Vec3& point_W,
                      const Vec3& towards_viewer_W, const Vec3& up_W);

}  // namespace osteomill
