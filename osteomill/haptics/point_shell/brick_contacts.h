#pragma once

#include "osteomill/haptics/point_shell/contact_sum.h"
#include "osteomill/haptics/point_shell/penalty.h"
#include "osteomill/haptics/point_shell/point_shell.h"

namespace osteomill::point_shell {

/// What `contacts_by_octree` says with the tool in closed form, to the rounding of the sums, and much faster:
/// nodes and bricks are culled by a sphere against the tool, a brick's points are sifted 32 at a time in
/// single precision, and those that may touch are summed in double precision, in a fixed order. Safe in the
/// haptic tick.
ToolContacts contacts_by_bricks(const PointShell& shell, const MillingTool& tool, const Pose& X_WT,
                                const Penalty& penalty);

}  // namespace osteomill::point_shell
