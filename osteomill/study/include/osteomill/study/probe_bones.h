#pragma once

#include "osteomill/haptics/milling_tool.h"
#include "osteomill/volume/volume.h"

/// Bones of known shape, on which algorithms are probed; the right answer is known there. Each has an edge of
/// two voxels.
namespace osteomill {

/// Returns bone that fills z < 0 (W), wide and deep enough to press this tool on, of voxels a twelfth of the
/// burr's radius (0.05 to 0.5 mm).
Volume flat_wall(const MillingTool& tool);

/// Returns bone with a sharp edge along y (W) at the origin, both its faces falling away at 45 degrees: wide
/// and fine enough for this tool's shaft to lie across.
Volume sharp_edge(const MillingTool& tool);

}  // namespace osteomill
