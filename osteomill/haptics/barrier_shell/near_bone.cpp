#include "osteomill/haptics/barrier_shell/near_bone.h"

#include <algorithm>
#include <cmath>

#include "osteomill/haptics/bone_points/tool_from_grid.h"

namespace osteomill::barrier_shell {

namespace {

// More than the rounding of a place near the tool.
constexpr double kClear_mm = 1e-4;

// Which core a sphere of points may touch within the room.
struct Meeting {
  const Cores& cores;
  double reach_mm;
  double turn_rad;

  bool ball(const Vec3& centre_T, double radius_mm) const {
    const double within = cores.ball_radius_mm + reach_mm + radius_mm + kClear_mm;
    return centre_T.squaredNorm() < within * within;
  }
  bool cylinder(const Vec3& centre_T, double radius_mm) const {
    const double z = centre_T.z();
    const double rho2 = centre_T.x() * centre_T.x() + centre_T.y() * centre_T.y();
    const double lever = std::sqrt(rho2 + z * z) + radius_mm;
    const double within = reach_mm + turn_rad * lever + radius_mm + kClear_mm;
    const double beside = cores.cylinder_radius_mm + within;
    if (rho2 >= beside * beside) return false;
    return z > -within && z < cores.cylinder_length_mm + within;
  }
};

Meeting meeting(const Cores& cores, const Barrier& barrier, const Room& room) {
  return {cores, barrier.width_mm + room.move_mm, room.turn_rad};
}

}  // namespace

NearBone::NearBone(std::size_t capacity) : ball_(capacity), cylinder_(capacity) {}

void NearBone::gather(BoneBricks& bricks, const Cores& cores, const Barrier& barrier, const Pose& X_WT,
                      const Room& room) {
  X_WT_gathered_ = X_WT;
  ball_.count = cylinder_.count = 0;
  ball_.overflowed = cylinder_.overflowed = false;
  const SurfaceLattice& lattice = bricks.lattice();
  const ToolFromGrid X_TG(lattice, X_WT);
  const Meeting meets = meeting(cores, barrier, room);
  const Reach reach{meets.reach_mm, room.turn_rad};
  const auto meets_node = [&](const Vec3& middle_G, double radius_mm) {
    const Vec3 middle_T = X_TG * middle_G;
    return meets.ball(middle_T, radius_mm) || meets.cylinder(middle_T, radius_mm);
  };
  bricks.visit(meets_node, [&](const VoxelIndex& brick_index, std::uint32_t slot) {
    const Vec3 origin_T = X_TG * lattice.brick_origin_G(brick_index);
    const Frame frame = frame_of(X_TG.turn, origin_T);
    const auto each = [&](const BrickPoints& points, auto&& meets_core, auto&& gather_points,
                          NearPoints& near) {
      const BrickPoints::Brick& brick = points.brick(slot);
      const Vec3 centre_T = origin_T + X_TG.turn * brick.bound.centre();
      if (!meets_core(centre_T, static_cast<double>(brick.bound.radius_mm))) return;
      gather_points(points, brick.first_chunk, frame, cores, reach, near);
    };
    each(
        bricks.fine(), [&](const Vec3& c, double r) { return meets.ball(c, r); }, gather_near_ball, ball_);
    each(
        bricks.coarse(), [&](const Vec3& c, double r) { return meets.cylinder(c, r); }, gather_near_cylinder,
        cylinder_);
  });
  close_gathering(ball_);
  close_gathering(cylinder_);
}

NearBone::Energy NearBone::energy(const Cores& cores, const Barrier& barrier, const Pose& X_WT) {
  const Mat3 R_TW = X_WT.orientation.conjugate().toRotationMatrix();
  const Frame moved = frame_of(R_TW * X_WT_gathered_.orientation.toRotationMatrix(),
                               R_TW * (X_WT_gathered_.position_mm - X_WT.position_mm));
  return {ball_energy(ball_, moved, cores, barrier), cylinder_energy(cylinder_, moved, cores, barrier)};
}

double NearBone::certified(const MoveT& move, const Barrier& barrier) const {
  return certified_share(
      std::max(max_use_by_ball(ball_, move, barrier), max_use_by_cylinder(cylinder_, move, barrier)));
}

bool is_clear(BoneBricks& bricks, const Cores& cores, const Barrier& barrier, const Pose& X_WT,
              const Room& room) {
  const ToolFromGrid X_TG(bricks.lattice(), X_WT);
  const Meeting meets = meeting(cores, barrier, room);
  return !bricks.may_hold_points([&](const Vec3& middle_G, double radius_mm) {
    const Vec3 middle_T = X_TG * middle_G;
    return meets.ball(middle_T, radius_mm) || meets.cylinder(middle_T, radius_mm);
  });
}

}  // namespace osteomill::barrier_shell
