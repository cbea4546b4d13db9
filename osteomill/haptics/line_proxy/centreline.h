#pragma once

#include <vector>

#include "osteomill/geometry/pose.h"
#include "osteomill/tool/milling_tool.h"

namespace osteomill {

/// The centreline as `count` vertices in T (count >= 2): the burr's centre first, then evenly up the shaft.
std::vector<Vec3> centreline_vertices(const MillingTool& tool, int count);

}  // namespace osteomill
