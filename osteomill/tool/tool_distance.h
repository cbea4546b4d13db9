#pragma once

#include "osteomill/tool/milling_tool.h"

namespace osteomill {

/// The distance of a point to the tool's surface, negative inside, and the unit direction in which it grows
/// fastest (out of the tool), both in T. On the axis, where there is no such direction, some unit vector.
struct ToolDistance {
  double distance_mm;
  Vec3 outward_T;
};

/// In closed form: the smaller of the distances to the burr's sphere and the shaft's cylinder, which outside
/// the tool is exact and inside it is exact away from where the two meet. Safe in the haptic tick.
ToolDistance tool_distance(const MillingTool& tool, const Vec3& point_T);

}  // namespace osteomill
