#pragma once

#include <optional>

#include "osteomill/haptics/line_proxy/bone_surface.h"
#include "osteomill/tool/milling_tool.h"
#include "osteomill/volume/volume.h"

namespace osteomill::line_proxy {

/// How a tool moves out of the bone that its radii reach into where they reach deepest; nothing where they do
/// not. One such move at a time brings it free, or to rest between two walls. Looked at are 24 points of the
/// burr and 8 of each millimetre of shaft; what is thinner than their spacing is missed, as is bone round the
/// centreline itself. Safe in the haptic tick.
std::optional<Vec3> clearing_move(const Volume& volume, const MillingTool& tool, const Pose& X_WT,
                                  const NormalRule& normal);

}  // namespace osteomill::line_proxy
