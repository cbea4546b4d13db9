#pragma once

#include "osteomill/haptics/milling_tool.h"
#include "osteomill/volume/volume.h"

/// Bones of known shape for probing algorithms: the correct result is known. The density ramp at their
/// surface is two voxels wide.
namespace osteomill {

/// Returns bone that fills z < 0 (W), wide and deep enough to press this tool on, with voxels of a twelfth of
/// the burr's radius (0.05 to 0.5 mm).
Volume flat_wall(const MillingTool& tool);

/// Returns bone with a sharp edge along y (W) at the origin, whose faces both slope down at 45 degrees; wide
/// and fine enough for this tool's shaft to lie across it.
Volume sharp_edge(const MillingTool& tool);

}  // namespace osteomill
