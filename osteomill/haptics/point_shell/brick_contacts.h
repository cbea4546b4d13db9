#pragma once

#include "osteomill/haptics/bone_points/near_bone.h"
#include "osteomill/haptics/point_shell/contact_sum.h"

namespace osteomill::point_shell {

/// The points of the isosurface that push the tool at `X_WT`, summed in W's axes, as each by itself does
/// (contact_point.h), to the rounding of single precision; what is nearest to the burr's sphere is the
/// burr's. `near` is of points that meet the nearest part. Makes the bricks that the tool comes near. Safe in
/// the haptic tick.
ToolContacts contacts_by_bricks(BoneBricks& bricks, NearBone& near, const MillingTool& tool, const Pose& X_WT,
                                const Penalty& penalty);

}  // namespace osteomill::point_shell
