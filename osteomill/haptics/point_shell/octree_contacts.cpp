#include "osteomill/haptics/point_shell/octree_contacts.h"

#include "osteomill/haptics/point_shell/contact_point.h"

namespace osteomill::point_shell {

namespace {

// Whether one of the six face directions of the two boxes separates them. The nine directions across pairs of
// edges would part a few more boxes; all that costs is a look at their points.
bool is_apart(const ToolBox& tool_box, const VoxelShell::NodeBox& node, const ToolFromGrid& X_TG) {
  const Vec3 tool_half = 0.5 * (tool_box.max_mm - tool_box.min_mm);
  const Vec3 between = X_TG * node.middle_G - 0.5 * (tool_box.max_mm + tool_box.min_mm);
  const Mat3 reach = X_TG.turn.cwiseAbs();
  const Vec3 along_tool = tool_half + reach * node.half_mm;
  if ((between.cwiseAbs().array() > along_tool.array()).any()) return true;
  const Vec3 along_node = node.half_mm + reach.transpose() * tool_half;
  return ((X_TG.turn.transpose() * between).cwiseAbs().array() > along_node.array()).any();
}

}  // namespace

ToolContacts contacts_by_octree(const VoxelShell& shell, const ToolSignedDistance& tool, const Pose& X_WT,
                                const Penalty& penalty) {
  const ToolFromGrid X_TG(shell, X_WT);
  ToolContacts contacts;
  const Vec3 reach_mm = Vec3::Constant(penalty.reach_mm());
  const ToolBox box{tool.box().min_mm - reach_mm, tool.box().max_mm + reach_mm};
  shell.octree().visit(
      [&](int level, int i, int j, int k) { return is_apart(box, shell.node_box(level, i, j, k), X_TG); },
      [&](int bi, int bj, int bk) {
        const Vec3 origin_T = X_TG * shell.brick_origin_G(bi, bj, bk);
        shell.points().for_each_of(shell.brick_index(bi, bj, bk), [&](const ShellPoint& point) {
          touch_point(point, origin_T + X_TG.turn * point.position_mm(), X_TG, tool, penalty, contacts);
        });
      });
  const Mat3 R_WT = X_WT.orientation.toRotationMatrix();
  return {contacts.burr.in_outer(R_WT), contacts.shaft.in_outer(R_WT), contacts.touching};
}

}  // namespace osteomill::point_shell
