#include "barrier_shell/near_bone.h"

#include <algorithm>
#include <cmath>

#include "barrier_shell/near_kernel.h"
#include "bone_points/tool_from_grid.h"

namespace osteomill::barrier_shell {

namespace {

// Margin above the rounding error of a position near the tool, mm.
constexpr double kClear_mm = 1e-4;

constexpr std::size_t kBricks = 4096;

bool can_reach_ball(const GatherRegion& region, const Vec3& centre_T, double radius_mm) {
  const double within = region.cores.ball_radius_mm + region.near_mm + radius_mm + kClear_mm;
  return centre_T.squaredNorm() < within * within;
}

bool can_reach_cylinder(const GatherRegion& region, const Vec3& centre_T, double radius_mm) {
  const double z = centre_T.z();
  const double rho2 = centre_T.x() * centre_T.x() + centre_T.y() * centre_T.y();
  const double lever = std::sqrt(rho2 + z * z) + radius_mm;
  const double within = region.near_mm + region.per_lever * lever + radius_mm + kClear_mm;
  const double beside = region.cores.cylinder_radius_mm + within;
  if (rho2 >= beside * beside) return false;
  return z > -within && z < region.cores.cylinder_length_mm + within;
}

// Tests which children of an octree node may contain points near the tool: can_reach_ball or
// can_reach_cylinder of their bounding spheres, eight at a time in SIMD, because every tick tests hundreds.
class NodeOverlapTest {
 public:
  NodeOverlapTest(const SurfaceLattice& lattice, const ToolFromGrid& X_TG, const GatherRegion& region)
      : lattice_(lattice),
        region_(region),
        first_T_(X_TG * lattice.before_first_G()),
        half_brick_T_(X_TG.turn * lattice.half_brick_mm().asDiagonal()) {
    for (int n = 0; n < 8; ++n) {
      const VoxelIndex octant = BrickTree::below({}, n);
      octants_T_.row(n) = half_brick_T_ * Vec3(2 * octant.i - 1, 2 * octant.j - 1, 2 * octant.k - 1);
    }
  }
  BrickTree::EightBits operator()(int level, const VoxelIndex& node) const {
    const Vec3 n = SurfaceLattice::half_bricks_to_middle(level, node);
    const Vec3 middle_T =
        first_T_ + n.x() * half_brick_T_.col(0) + n.y() * half_brick_T_.col(1) + n.z() * half_brick_T_.col(2);
    const double size = static_cast<double>(1 << (level - 1));
    const double radius_mm = lattice_.radius_mm(level - 1);
    const double near_mm = region_.near_mm + radius_mm + kClear_mm;
    const double ball_mm = region_.cores.ball_radius_mm + near_mm;
    const Eight x = middle_T.x() + size * octants_T_.col(0).array();
    const Eight y = middle_T.y() + size * octants_T_.col(1).array();
    const Eight z = middle_T.z() + size * octants_T_.col(2).array();
    const Eight rho2 = x * x + y * y;
    const Eight r2 = rho2 + z * z;
    const Eight within = near_mm + region_.per_lever * (r2.sqrt() + radius_mm);
    const Eight beside = region_.cores.cylinder_radius_mm + within;
    const Eight ends = (-z).max(z - region_.cores.cylinder_length_mm) - within;
    // Negative if the sphere overlaps the region.
    const Eight gap = (rho2 - beside * beside).max(ends).min(r2 - ball_mm * ball_mm);
    unsigned met = 0;
    for (int below = 0; below < 8; ++below) met |= static_cast<unsigned>(gap[below] < 0) << below;
    return static_cast<BrickTree::EightBits>(met);
  }

 private:
  using Eight = Eigen::Array<double, 8, 1>;

  const SurfaceLattice& lattice_;
  const GatherRegion& region_;
  Vec3 first_T_;
  Mat3 half_brick_T_;
  // Offsets in T from a node's centre to those of its eight children, for children one brick wide.
  Eigen::Matrix<double, 8, 3> octants_T_;
};

}  // namespace

NearBone::NearBone(std::size_t capacity, bool fine_at_cylinder)
    : fine_at_cylinder_(fine_at_cylinder),
      bricks_(capacity > 0 ? kBricks : 0),
      ball_(capacity),
      cylinder_(capacity) {}

void NearBone::gather(BoneBricks& bricks, const Cores& cores, double reach_mm, const Pose& X_WT,
                      const MoveSize& leeway) noexcept {
  X_WT_gathered_ = X_WT;
  const BrickPoints& at_cylinder = fine_at_cylinder_ ? bricks.fine() : bricks.coarse();
  const ToolFromGrid X_TG(bricks.lattice(), X_WT);
  const GatherRegion region{cores, reach_mm + leeway.move_mm, leeway.turn_rad};
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
    if (can_reach_ball(region, middle_T(bricks.fine()), radius_mm(bricks.fine()))) {
      gather_near_ball(bricks.fine(), bricks.fine().brick(slot).first_chunk, frame, region, ball_);
    }
    if (can_reach_cylinder(region, middle_T(at_cylinder), radius_mm(at_cylinder))) {
      gather_near_cylinder(at_cylinder, at_cylinder.brick(slot).first_chunk, frame, region, cylinder_);
    }
  };
  ball_.count = cylinder_.count = brick_count_ = 0;
  ball_.overflowed = cylinder_.overflowed = false;
  brick_missing_ = !bricks.build_and_visit(NodeOverlapTest(bricks.lattice(), X_TG, region), gather_brick);
  pad_last_lanes(ball_);
  pad_last_lanes(cylinder_);
}

void NearBone::measure(const Cores& cores, const Barrier& barrier, const Pose& X_WT,
                       MeasuredBone& measured) const noexcept {
  const Mat3 R_TW = X_WT.orientation.conjugate().toRotationMatrix();
  const Frame moved = frame_of(R_TW * X_WT_gathered_.orientation.toRotationMatrix(),
                               R_TW * (X_WT_gathered_.position_mm - X_WT.position_mm));
  measure_ball(ball_, moved, cores, barrier, measured.ball);
  measure_cylinder(cylinder_, moved, cores, barrier, measured.cylinder);
}

void NearBone::list_supporting(const MeasuredBone& measured, double within_mm,
                               BoneBricks& bricks) const noexcept {
  constexpr auto kNearest = static_cast<float>(Barrier::kNearestShare);
  const auto within = static_cast<float>(within_mm);
  // Sums the barrier's pressure over points, without its factor p0 (3 - 2 x) / 3.
  const auto load_on = [&](const NearPoints& near, const MeasuredPoints& points, std::size_t first,
                           std::size_t end) {
    float load = 0;
    for (std::size_t n = first; n < end; ++n) {
      const float share = std::max(points.distance[n] / within, kNearest);
      if (share < 1) load += near.area[n] * (1 - share) * (1 - share) / (share * share);
    }
    return load;
  };
  bricks.clear_supporting();
  for (std::size_t n = 0; n < brick_count_; ++n) {
    const bool last = n + 1 == brick_count_;
    const float load =
        load_on(ball_, measured.ball, bricks_[n].at_ball, last ? ball_.count : bricks_[n + 1].at_ball) +
        load_on(cylinder_, measured.cylinder, bricks_[n].at_cylinder,
                last ? cylinder_.count : bricks_[n + 1].at_cylinder);
    if (load > 0) bricks.add_supporting(bricks_[n].slot, load);
  }
}

double MeasuredBone::max_use(const Vector6& move_T, const Barrier& barrier) const noexcept {
  const double min_mm = Barrier::kNearestShare * barrier.width_mm;
  return std::max(max_use_by_ball(ball, move_T, min_mm), max_use_by_cylinder(cylinder, move_T, min_mm));
}

bool check_clearance(BoneBricks& bricks, const Cores& cores, double reach_mm, const Pose& X_WT,
                     const MoveSize& leeway) noexcept {
  const ToolFromGrid X_TG(bricks.lattice(), X_WT);
  const GatherRegion region{cores, reach_mm + leeway.move_mm, leeway.turn_rad};
  return !bricks.search_for_points(NodeOverlapTest(bricks.lattice(), X_TG, region));
}

}  // namespace osteomill::barrier_shell
