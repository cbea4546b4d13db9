#pragma once

#include "osteomill/haptics/bone_points/near_bone.h"
#include "osteomill/haptics/point_shell/contact_sum.h"

namespace osteomill::point_shell {

/// The points of the isosurface that push the tool at `X_WT`, each by its penalty, summed in single precision
/// (Eriksson 2012, 6.3), in W's axes; what is nearest to the burr's sphere is the burr's. `near` is of points
/// that meet the nearest part. Makes the bricks that the tool comes near. Safe in the haptic tick.
ToolContacts contacts_by_bricks(BoneBricks& bricks, NearBone& near, const MillingTool& tool, const Pose& X_WT,
                                const Penalty& penalty);

}  // namespace osteomill::point_shell
