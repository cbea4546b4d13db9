#include "osteomill/haptics/point_shell/brick_contacts.h"

#include <algorithm>
#include <bit>

#include "osteomill/haptics/point_shell/brick_kernel.h"
#include "osteomill/haptics/point_shell/contact_point.h"

namespace osteomill::point_shell {

namespace {

// More than the rounding of a place near the tool.
constexpr double kClear_mm = 1e-6;

KernelTool kernel_tool(const ToolSignedDistance& tool, const Penalty& penalty) {
  const MillingTool& t = tool.tool();
  return {t.burr_radius_mm,
          t.shaft_radius_mm,
          t.shaft_length_mm,
          ToolSignedDistance::burr_top_mm(t),
          penalty.stiffness_N_per_mm3,
          penalty.max_patch_mm2,
          penalty.reach_mm()};
}

KernelFrame kernel_frame(const Mat3& turn_TG) {
  KernelFrame frame;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) frame.turn[row][column] = turn_TG(row, column);
  }
  return frame;
}

double lane_sum(const double (&lanes)[KernelSums::kLanes]) {
  double sum = 0;
  for (const double lane : lanes) sum += lane;
  return sum;
}

// On the shaft's side n = (u, w, 0) and r x n = z (-w, u, 0).
ContactSum side_sum(const KernelSums& sums) {
  double s[KernelSums::kSide];
  for (int n = 0; n < KernelSums::kSide; ++n) s[n] = lane_sum(sums.side[n]);
  // uu, uw, ww of k times 1, z and z^2; u and w make a unit vector.
  const double k[] = {s[5], s[6], s[4] - s[5]};
  const double kz[] = {s[8], s[9], s[7] - s[8]};
  const double kzz[] = {s[11], s[12], s[10] - s[11]};
  ContactSum sum;
  sum.force_N = {-s[0], -s[1], 0};
  sum.torque_Nmm = {s[3], -s[2], 0};
  sum.K_ff << k[0], k[1], 0, k[1], k[2], 0, 0, 0, 0;
  sum.K_ft << -kz[1], kz[0], 0, -kz[2], kz[1], 0, 0, 0, 0;
  sum.K_tt << kzz[2], -kzz[1], 0, -kzz[1], kzz[0], 0, 0, 0, 0;
  return sum;
}

// On the burr r x n = 0.
ContactSum sphere_sum(const KernelSums& sums) {
  double s[KernelSums::kSphere];
  for (int n = 0; n < KernelSums::kSphere; ++n) s[n] = lane_sum(sums.sphere[n]);
  ContactSum sum;
  sum.force_N = {-s[0], -s[1], -s[2]};
  sum.K_ff << s[3], s[4], s[5], s[4], s[6], s[7], s[5], s[7], s[8];
  return sum;
}

enum class Part : unsigned char { side, sphere, any };

// Which part of the tool all points in a sphere meet, if they meet it at all.
Part part_met(const KernelTool& tool, const Vec3& centre_T, double radius_mm) {
  const double min_z = centre_T.z() - radius_mm, max_z = centre_T.z() + radius_mm;
  const double beside_burr = std::max(tool.shaft_radius_mm, tool.burr_radius_mm + tool.reach_mm);
  const bool off_axis = centre_T.head<2>().norm() > radius_mm + kClear_mm;
  if (off_axis && min_z > beside_burr && max_z < tool.shaft_length_mm - tool.shaft_radius_mm) {
    return Part::side;
  }
  return max_z < -tool.reach_mm - kClear_mm ? Part::sphere : Part::any;
}

// Whether a sphere lies clear of the tool. Beside a corner of the shaft's end it may say no where it is
// clear.
bool is_clear(const MillingTool& tool, const Vec3& centre_T, double radius_mm) {
  const double radial_squared = centre_T.x() * centre_T.x() + centre_T.y() * centre_T.y();
  const double z = centre_T.z();
  const double burr_reach = tool.burr_radius_mm + radius_mm;
  if (radial_squared + z * z <= burr_reach * burr_reach) return false;
  const double shaft_reach = tool.shaft_radius_mm + radius_mm;
  return radial_squared > shaft_reach * shaft_reach || z < -radius_mm || z > tool.shaft_length_mm + radius_mm;
}

}  // namespace

ToolContacts contacts_by_bricks(BoneBricks& bricks, const MillingTool& milling_tool, const Pose& X_WT,
                                const Penalty& penalty) {
  const ToolFromGrid X_TG(bricks.lattice(), X_WT);
  const ToolSignedDistance tool(milling_tool);
  const BrickPoints& points = bricks.fine();
  const double beyond_mm = penalty.reach_mm();
  const KernelTool shape = kernel_tool(tool, penalty);
  KernelFrame frame = kernel_frame(X_TG.turn);
  KernelSums sums;
  ToolContacts contacts;
  const auto meets_node = [&](const Vec3& middle_G, double radius_mm) {
    return !is_clear(milling_tool, X_TG * middle_G, radius_mm + beyond_mm);
  };
  bricks.visit(meets_node, [&](const VoxelIndex& brick_index, std::uint32_t slot) {
    const BrickPoints::Brick& brick = points.brick(slot);
    const double radius_mm = static_cast<double>(brick.bound.radius_mm);
    const Vec3 origin_T = X_TG * bricks.lattice().brick_origin_G(brick_index);
    const Vec3 centre_T = origin_T + X_TG.turn * brick.bound.centre();
    if (is_clear(milling_tool, centre_T, radius_mm + beyond_mm)) return;
    for (int axis = 0; axis < 3; ++axis) frame.origin_mm[axis] = origin_T[axis];
    const Part part = part_met(shape, centre_T, radius_mm);
    if (part == Part::side) return add_side_points(points, brick.first_chunk, frame, shape, sums);
    if (part == Part::sphere) return add_sphere_points(points, brick.first_chunk, frame, shape, sums);
    for (std::uint32_t c = brick.first_chunk; c != BrickPoints::kNoChunk; c = points.next_chunk(c)) {
      const PointChunk& chunk = points.chunk(c);
      for (std::uint32_t rest = add_points(chunk, frame, shape, sums); rest != 0; rest &= rest - 1) {
        const ShellPoint point = chunk.point(static_cast<std::size_t>(std::countr_zero(rest)));
        touch_point(point, origin_T + X_TG.turn * point.position_mm(), X_TG, tool, penalty, contacts);
      }
    }
  });
  contacts.burr += sphere_sum(sums);
  contacts.shaft += side_sum(sums);
  const Mat3 R_WT = X_WT.orientation.toRotationMatrix();
  return {contacts.burr.in_outer(R_WT), contacts.shaft.in_outer(R_WT), contacts.touching + sums.touching};
}

}  // namespace osteomill::point_shell
