#pragma once

#include "osteomill/haptics/bone_points/bone_bricks.h"
#include "osteomill/haptics/point_shell/contact_sum.h"
#include "osteomill/haptics/point_shell/penalty.h"

namespace osteomill::point_shell {

/// The points of the isosurface that push the tool at `X_WT`, summed in W's axes, as each by itself does
/// (contact_point.h): nodes and bricks are culled by a sphere against the tool, a brick's points are sifted
/// 32 at a time in single precision, and those that may touch are summed in double precision, in a fixed
/// order. Makes the bricks that the tool comes near. Safe in the haptic tick.
ToolContacts contacts_by_bricks(BoneBricks& bricks, const MillingTool& tool, const Pose& X_WT,
                                const Penalty& penalty);

}  // namespace osteomill::point_shell
