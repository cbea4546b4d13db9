#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "osteomill/base/pose.h"
#include "osteomill/milling/burr_reach.h"

namespace osteomill {

/// The density that cutting leaves `t` voxels outside a cut surface (inside it if negative), counted along
/// the surface's normal: the isovalue on it, the surroundings one voxel inside, as much above the isovalue
/// one voxel outside, and from there on so steep that bone soon stays as it is. It does not depend on what
/// was there, so cutting to the same surface again changes nothing. docs/algorithms.md.
struct CutProfile {
  float surroundings = 0;
  float isovalue = 0.5f;
  float per_voxel = 0.5f;
  float beyond_per_voxel = 4;

  /// The distance outside the surface up to which bone is lowered, if it is not more than three times as
  /// dense as the reference.
  static constexpr double kReach_voxels = 1.55;

  /// Returns the profile for these densities; the isovalue and the reference are above the surroundings.
  static CutProfile between(double surroundings, double isovalue, double reference) {
    return {static_cast<float>(surroundings), static_cast<float>(isovalue),
            static_cast<float>(isovalue - surroundings), static_cast<float>(4 * (reference - surroundings))};
  }
  float density(float t) const {
    return std::max(surroundings, isovalue + per_voxel * t + beyond_per_voxel * std::max(0.0f, t - 1));
  }
};

/// The burr's ball as it cuts, in the grid's axes, mm from the first voxel's centre.
struct CuttingBall {
  Vec3 centre_mm = Vec3::Zero();
  /// The direction in which the burr presses: a unit vector, along its force on the bone.
  Vec3 ahead = Vec3::UnitZ();
  double radius_mm = 0;
};

/// The lists in which CutVoxels gathers, with one entry a voxel and room for `kLanes` entries behind the
/// last.
struct CutLists {
  static constexpr std::size_t kLanes = 8;
  std::size_t size = 0;
  /// The squared distance from the ball's centre, the distance ahead of it, and the number of voxels per mm
  /// along the ball's normal.
  std::vector<float> distance2_mm2, ahead_mm, voxels_per_mm;
  std::vector<int> columns;
  std::vector<float> before, after;
};

/// The voxels that a ball would lower: all that it overlaps except those that are cut already. The half of
/// the ball that lies ahead of its centre (leading) is moved along `ahead`, the other half (trailing) stays.
class CutVoxels {
 public:
  /// Allocates room for `voxels` voxels and `rows` rows at once.
  CutVoxels(const GridGeometry& geometry, std::size_t voxels, std::size_t rows);

  /// Gathers, from the rows found about the ball, the voxels that it lowers with the leading half up to
  /// `max_ahead_mm` ahead. Lets `reach` forget what holds nothing.
  void gather(BurrReach& reach, const CuttingBall& ball, const CutProfile& profile,
              double max_ahead_mm) noexcept;

  /// The cost of cutting to the ball's surface, as sums of densities.
  struct Cost {
    double leading = 0;
    /// The growth of `leading` as the ball goes ahead.
    double slope_per_mm = 0;
    double trailing = 0;
  };
  Cost cost(double ahead_mm) const noexcept;

  /// The part of each drop that is made.
  struct Shares {
    double leading = 1;
    double trailing = 1;
  };
  /// Fills `after()`; returns the sum of the drops, exact for the floats that they are.
  double find_lowered(double ahead_mm, const Shares& shares) noexcept;

  /// A row's voxels are [begin, end) of the lists below.
  struct Row {
    int j;
    int k;
    std::size_t begin;
    std::size_t end;
  };
  const std::vector<Row>& rows() const { return rows_; }
  const int* columns() const { return lists_.columns.data(); }
  const float* before() const { return lists_.before.data(); }
  const float* after() const { return lists_.after.data(); }

 private:
  void measure(const CuttingBall& ball, double reach_mm);

  GridGeometry geometry_;
  float radius_mm_ = 0;
  CutProfile profile_;
  CutLists lists_;
  std::vector<Row> rows_;
  // Along each axis: how far each plane of voxels lies from the ball's centre.
  std::array<std::vector<float>, 3> from_centre_mm_;
};

/// The distance ahead of its centre at which a ball cuts, and the part of each drop that is made.
struct BurrAdvance {
  double ahead_mm = 0;
  CutVoxels::Shares shares;
  /// `CutVoxels::Cost::slope_per_mm` there.
  double slope_per_mm = 0;
};

/// Returns the ball's place between `min_ahead_mm` and `max_ahead_mm` where cutting to its surface takes just
/// the `budget` (a sum of densities, above 0); searched from `start_ahead_mm`. Bone that the trailing half
/// overlaps is paid first, with at most half the budget. If even the least place takes more, part of each
/// drop is made; no more is spent than the budget, except by the rounding of floats. Safe in the haptic tick.
BurrAdvance advance_within(double budget, const CutVoxels& voxels, double start_ahead_mm, double min_ahead_mm,
                           double max_ahead_mm) noexcept;

}  // namespace osteomill
