#pragma once

#include "osteomill/haptics/line_proxy/surface_normal.h"
#include "osteomill/tool/milling_tool.h"
#include "osteomill/volume/volume.h"

namespace osteomill::line_proxy {

/// A tool whose centreline is free, moved out of the bone that its radii reach into, so that it is not shown
/// in bone before its line touches. Looked at are 26 points of the burr and 8 of each millimetre of shaft, a
/// few rounds; what is thinner than their spacing is missed. Safe in the haptic tick.
Vec3 cleared_position(const Volume& volume, const MillingTool& tool, const Pose& X_WT,
                      const NormalRule& normal);

}  // namespace osteomill::line_proxy
