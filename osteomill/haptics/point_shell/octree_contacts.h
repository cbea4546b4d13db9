#pragma once

#include "osteomill/haptics/point_shell/contact_sum.h"
#include "osteomill/haptics/point_shell/tool_signed_distance.h"
#include "osteomill/haptics/point_shell/voxel_shell.h"

namespace osteomill::point_shell {

/// The points of the shell that lie in the tool at `X_WT`, summed in W's axes (Eriksson 2012, 6.2 and 6.3):
/// boxes of the octree against the tool's bounding box, then each point of the boxes left against the tool's
/// distance. A point at the depth d pushes with `stiffness_N_per_mm3` times its area times d. Safe in the
/// haptic tick.
ToolContacts contacts_by_octree(const VoxelShell& shell, const ToolSignedDistance& tool, const Pose& X_WT,
                                double stiffness_N_per_mm3);

}  // namespace osteomill::point_shell
