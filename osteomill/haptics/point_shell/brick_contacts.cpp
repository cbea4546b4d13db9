#include "osteomill/haptics/point_shell/brick_contacts.h"

namespace osteomill::point_shell {

namespace {

// As they act on the tool.
ContactSum contact_sum(const EnergySum& sum) {
  return {-sum.gradient.head<3>(), -sum.gradient.tail<3>(), sum.convex.topLeftCorner<3, 3>(),
          sum.convex.topRightCorner<3, 3>(), sum.convex.bottomRightCorner<3, 3>()};
}

}  // namespace

ToolContacts contacts_by_bricks(BoneBricks& bricks, NearBone& near, const MillingTool& tool, const Pose& X_WT,
                                const Penalty& penalty) {
  const Cores whole{tool.burr_radius_mm, tool.shaft_radius_mm, tool.shaft_length_mm};
  near.gather(bricks, whole, penalty.reach_mm(), X_WT, {});
  const NearBone::Energy found = near.energy(whole, penalty, X_WT);
  const Mat3 R_WT = X_WT.orientation.toRotationMatrix();
  return {contact_sum(found.ball).in_outer(R_WT), contact_sum(found.cylinder).in_outer(R_WT),
          found.ball.touching + found.cylinder.touching};
}

}  // namespace osteomill::point_shell
