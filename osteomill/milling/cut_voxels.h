#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "osteomill/geometry/pose.h"
#include "osteomill/milling/burr_reach.h"
#include "osteomill/milling/cut_profile.h"

namespace osteomill {

/// The burr's ball as it cuts, in the grid's axes, mm from the first voxel's centre.
struct CuttingBall {
  Vec3 centre_mm = Vec3::Zero();
  /// Where the burr presses: a unit vector, along its force on the bone.
  Vec3 ahead = Vec3::UnitZ();
  double radius_mm = 0;
};

/// Lists of one entry a voxel, with room for `kLanes` entries behind the last.
struct CutLists {
  static constexpr std::size_t kLanes = 8;
  std::size_t size = 0;
  /// The squared distance from the ball's centre, the distance ahead of it, and voxels a mm along the
  /// ball's normal.
  std::vector<float> distance2_mm2, ahead_mm, voxels_per_mm;
  std::vector<int> columns;
  std::vector<float> before, after;
};

/// The voxels that a ball would lower: all that it overlaps but for what is cut already. The half of the ball
/// that lies ahead of its centre (leading) is moved along `ahead`, the other half (trailing) stays.
class CutVoxels {
 public:
  /// Room for so many voxels and rows at once.
  CutVoxels(const GridGeometry& geometry, std::size_t voxels, std::size_t rows);

  /// From the rows found about the ball: what it lowers with the leading half up to `max_ahead_mm` ahead. Has
  /// `reach` forget what holds nothing.
  void gather(const DensityGrid& grid, BurrReach& reach, const CuttingBall& ball, const CutProfile& profile,
              double max_ahead_mm);

  /// What cutting to the ball's surface takes, as sums of densities.
  struct Cost {
    double leading = 0;
    /// How `leading` grows as the ball goes ahead.
    double slope_per_mm = 0;
    double trailing = 0;
  };
  Cost cost(double ahead_mm) const;

  /// The part of each drop that is made.
  struct Shares {
    double leading = 1;
    double trailing = 1;
  };
  /// Fills `after()`; returns the sum of the drops, exact for the floats that they are.
  double lower(double ahead_mm, const Shares& shares);

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

}  // namespace osteomill
