#include "barrier_shell/near_bone.h"

#include <algorithm>
#include <cmath>

#include "barrier_shell/near_kernel.h"
#include "bone_points/tool_from_grid.h"

namespace osteomill::barrier_shell {

namespace {

// More than the rounding of a place near the tool.
constexpr double kClear_mm = 1e-4;

constexpr std::size_t kBricks = 4096;

bool may_reach_ball(const Reach& reach, const Vec3& centre_T, double radius_mm) {
  const double within = reach.cores.ball_radius_mm + reach.near_mm + radius_mm + kClear_mm;
  return centre_T.squaredNorm() < within * within;
}

bool may_reach_cylinder(const Reach& reach, const Vec3& centre_T, double radius_mm) {
  const double z = centre_T.z();
  const double rho2 = centre_T.x() * centre_T.x() + centre_T.y() * centre_T.y();
  const double lever = std::sqrt(rho2 + z * z) + radius_mm;
  const double within = reach.near_mm + reach.per_lever * lever + radius_mm + kClear_mm;
  const double beside = reach.cores.cylinder_radius_mm + within;
  if (rho2 >= beside * beside) return false;
  return z > -within && z < reach.cores.cylinder_length_mm + within;
}

// Whether a sphere of points may come near the tool.
bool may_reach(const Reach& reach, const Vec3& centre_T, double radius_mm) {
  return may_reach_ball(reach, centre_T, radius_mm) || may_reach_cylinder(reach, centre_T, radius_mm);
}

}  // namespace

NearBone::NearBone(std::size_t room, bool fine_at_cylinder)
    : fine_at_cylinder_(fine_at_cylinder), bricks_(room > 0 ? kBricks : 0), ball_(room), cylinder_(room) {}

void NearBone::gather(BoneBricks& bricks, const Cores& cores, double reach_mm, const Pose& X_WT,
                      const Room& room) noexcept {
  X_WT_gathered_ = X_WT;
  const BrickPoints& at_cylinder = fine_at_cylinder_ ? bricks.fine() : bricks.coarse();
  const ToolFromGrid X_TG(bricks.lattice(), X_WT);
  const Reach reach{cores, reach_mm + room.move_mm, room.turn_rad};
  const auto meets_node = [&](const Vec3& middle_G, double radius_mm) {
    return may_reach(reach, X_TG * middle_G, radius_mm);
  };
  const auto gather_brick = [&](const VoxelIndex& brick, std::uint32_t slot) {
    if (brick_count_ < bricks_.size()) bricks_[brick_count_++] = {slot, ball_.count, cylinder_.count};
    const Vec3 origin_T = X_TG * bricks.lattice().brick_origin_G(brick);
    const Frame frame = frame_of(X_TG.turn, origin_T);
    const auto middle_T = [&](const BrickPoints& points) -> Vec3 {
      return origin_T + X_TG.turn * points.brick(slot).bound.centre();
    };
    const auto radius_mm = [&](const BrickPoints& points) {
      return static_cast<double>(points.brick(slot).bound.radius_mm);
    };
    if (may_reach_ball(reach, middle_T(bricks.fine()), radius_mm(bricks.fine()))) {
      gather_near_ball(bricks.fine(), bricks.fine().brick(slot).first_chunk, frame, reach, ball_);
    }
    if (may_reach_cylinder(reach, middle_T(at_cylinder), radius_mm(at_cylinder))) {
      gather_near_cylinder(at_cylinder, at_cylinder.brick(slot).first_chunk, frame, reach, cylinder_);
    }
  };
  ball_.count = cylinder_.count = brick_count_ = 0;
  ball_.overflowed = cylinder_.overflowed = false;
  brick_missing_ = !bricks.make_and_visit(meets_node, gather_brick);
  close_gathering(ball_);
  close_gathering(cylinder_);
}

void NearBone::measure(const Cores& cores, const Barrier& barrier, const Pose& X_WT,
                       MeasuredBone& measured) const noexcept {
  const Mat3 R_TW = X_WT.orientation.conjugate().toRotationMatrix();
  const Frame moved = frame_of(R_TW * X_WT_gathered_.orientation.toRotationMatrix(),
                               R_TW * (X_WT_gathered_.position_mm - X_WT.position_mm));
  measure_ball(ball_, moved, cores, barrier, measured.ball);
  measure_cylinder(cylinder_, moved, cores, barrier, measured.cylinder);
}

void NearBone::find_bearing(const MeasuredBone& measured, double within_mm,
                            BoneBricks& bricks) const noexcept {
  const auto within = static_cast<float>(within_mm);
  const auto bears = [&](const MeasuredPoints& points, std::size_t first, std::size_t end) {
    const float* distance = points.distance.data();
    return std::any_of(distance + first, distance + end, [&](float mm) { return mm < within; });
  };
  bricks.clear_bearing();
  for (std::size_t n = 0; n < brick_count_; ++n) {
    const bool last = n + 1 == brick_count_;
    if (bears(measured.ball, bricks_[n].at_ball, last ? ball_.count : bricks_[n + 1].at_ball) ||
        bears(measured.cylinder, bricks_[n].at_cylinder,
              last ? cylinder_.count : bricks_[n + 1].at_cylinder)) {
      bricks.add_bearing(bricks_[n].slot);
    }
  }
}

double MeasuredBone::max_use(const Vector6& move_T, const Barrier& barrier) const noexcept {
  const double min_mm = Barrier::kNearestShare * barrier.width_mm;
  return std::max(max_use_by_ball(ball, move_T, min_mm), max_use_by_cylinder(cylinder, move_T, min_mm));
}

bool look_if_clear(BoneBricks& bricks, const Cores& cores, double reach_mm, const Pose& X_WT,
                   const Room& room) noexcept {
  const ToolFromGrid X_TG(bricks.lattice(), X_WT);
  const Reach reach{cores, reach_mm + room.move_mm, room.turn_rad};
  return !bricks.look_for_points(
      [&](const Vec3& middle_G, double radius_mm) { return may_reach(reach, X_TG * middle_G, radius_mm); });
}

}  // namespace osteomill::barrier_shell
