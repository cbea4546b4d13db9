#pragma once

#include <optional>

#include "osteomill/tool/milling_tool.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// A pose of the tool free of bone, before a point of it as someone sees it who looks against
/// `towards_viewer_W` with `up_W` up (both unit, at a right angle): the burr's surface 3 mm before the point,
/// or as much further towards the viewer as it takes, and the shaft towards the viewer, tilted upwards and
/// aside as far as bone lets it, so that it does not hide the burr. Bone is a millimetre away at least. Not
/// for the tick.
Pose free_pose_before(const Volume& volume, const MillingTool& tool, const Vec3& point_W,
                      const Vec3& towards_viewer_W, const Vec3& up_W);

}  // namespace osteomill
