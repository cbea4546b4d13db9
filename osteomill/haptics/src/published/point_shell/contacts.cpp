#include "published/point_shell/contacts.h"

#include <algorithm>
#include <cmath>

#include "bone_points/tool_from_grid.h"

namespace osteomill::point_shell {

namespace {

// Returns whether one of the six face normals of the two boxes separates them. Omits the nine axes across
// pairs of edges: they would separate few more boxes, and a miss costs only testing the box's points.
bool is_apart(const ToolBox& tool_box, const VoxelShell::NodeBox& node, const ToolFromGrid& X_TG) {
  const Vec3 tool_half = 0.5 * (tool_box.max_mm - tool_box.min_mm);
  const Vec3 between = X_TG * node.middle_G - 0.5 * (tool_box.max_mm + tool_box.min_mm);
  const Mat3 reach = X_TG.turn.cwiseAbs();
  const Vec3 along_tool = tool_half + reach * node.half_mm;
  if ((between.cwiseAbs().array() > along_tool.array()).any()) return true;
  const Vec3 along_node = node.half_mm + reach.transpose() * tool_half;
  return ((X_TG.turn.transpose() * between).cwiseAbs().array() > along_node.array()).any();
}

// Returns the sum in the axes of an outer frame; `R` rotates into it.
EnergySum in_outer(const Mat3& R, const EnergySum& sum) {
  const auto turned = [&](const Mat3& K) -> Mat3 { return R * K * R.transpose(); };
  EnergySum outer;
  outer.touching = sum.touching;
  outer.gradient << R * sum.gradient.head<3>(), R * sum.gradient.tail<3>();
  const Mat3 coupled = turned(sum.convex.topRightCorner<3, 3>());
  outer.convex << turned(sum.convex.topLeftCorner<3, 3>()), coupled, coupled.transpose(),
      turned(sum.convex.bottomRightCorner<3, 3>());
  return outer;
}

ToolContacts in_world(const EnergySum& burr_T, const EnergySum& shaft_T, const Pose& X_WT) {
  const Mat3 R_WT = X_WT.orientation.toRotationMatrix();
  return {in_outer(R_WT, burr_T), in_outer(R_WT, shaft_T)};
}

}  // namespace

void add_contact(EnergySum& sum, double push_N, double stiffness_N_per_mm, const Vec3& n, const Vec3& r_mm) {
  Vector6 along;
  along << n, r_mm.cross(n);
  sum.gradient += push_N * along;
  sum.convex += stiffness_N_per_mm * along * along.transpose();
  ++sum.touching;
}

double burr_top_mm(const MillingTool& tool) {
  const double squared =
      tool.burr_radius_mm * tool.burr_radius_mm - tool.shaft_radius_mm * tool.shaft_radius_mm;
  return std::sqrt(std::max(0.0, squared));
}

ToolContacts contacts_by_octree(const VoxelShell& shell, const MillingTool& tool,
                                const SampledDistanceField& field, const Pose& X_WT,
                                double stiffness_N_per_mm3) {
  const ToolFromGrid X_TG(shell, X_WT);
  const ToolBox box = bounding_box(tool);
  const double burr_top = burr_top_mm(tool);
  ToolContacts contacts;
  const auto add = [&](const ShellPoint& point, const Vec3& origin_T) {
    const Vec3 point_T = origin_T + X_TG.turn * point.position_mm();
    const std::optional<ToolDistance> distance = field.at(point_T);
    if (!distance || !(distance->distance_mm < 0)) return;
    const double k = stiffness_N_per_mm3 * static_cast<double>(point.area_mm2);
    add_contact(point_T.z() < burr_top ? contacts.burr : contacts.shaft, -k * distance->distance_mm, k,
                distance->outward_T, point_T);
  };
  shell.visit_bricks([&](const VoxelShell::NodeBox& node) { return is_apart(box, node, X_TG); },
                     [&](std::size_t brick, const Vec3& origin_G) {
                       const Vec3 origin_T = X_TG * origin_G;
                       shell.points().for_each_of(brick,
                                                  [&](const ShellPoint& point) { add(point, origin_T); });
                     });
  return in_world(contacts.burr, contacts.shaft, X_WT);
}

}  // namespace osteomill::point_shell
