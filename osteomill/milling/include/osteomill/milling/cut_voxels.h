#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "osteomill/base/pose.h"
#include "osteomill/milling/burr_reach.h"

namespace osteomill {

/// Density that cutting leaves at a signed distance `t`, in voxels along the normal, from the cut surface
/// (positive outside the burr): the isovalue on the surface, the surroundings' density one voxel inside,
/// linear up to one voxel outside, and steeper beyond, so that bone farther out is unchanged. Independent of
/// the previous density, so cutting to the same surface again changes nothing. See docs/algorithms.md.
struct CutProfile {
  float surroundings = 0;
  float isovalue = 0.5f;
  float per_voxel = 0.5f;
  float beyond_per_voxel = 4;

  /// Distance outside the surface up to which bone is lowered; holds for bone up to three times the reference
  /// density.
  static constexpr double kReach_voxels = 1.55;

  /// Returns the profile for these densities. The isovalue and the reference must be above the surroundings.
  static CutProfile between(double surroundings, double isovalue, double reference) {
    return {static_cast<float>(surroundings), static_cast<float>(isovalue),
            static_cast<float>(isovalue - surroundings), static_cast<float>(4 * (reference - surroundings))};
  }
  float density(float t) const {
    return std::max(surroundings, isovalue + per_voxel * t + beyond_per_voxel * std::max(0.0f, t - 1));
  }
};

/// The cutting ball in the grid's axes, mm from the first voxel's centre.
struct CuttingBall {
  Vec3 centre_mm = Vec3::Zero();
  /// Unit vector along the burr's force on the bone.
  Vec3 ahead = Vec3::UnitZ();
  double radius_mm = 0;
};

/// Structure of arrays filled by CutVoxels::gather, one entry per voxel, padded by `kLanes` entries.
struct CutLists {
  static constexpr std::size_t kLanes = 8;
  std::size_t size = 0;
  /// Squared distance from the ball's centre, distance ahead of it, and voxels per mm along the ball's
  /// normal.
  std::vector<float> distance2_mm2, ahead_mm, voxels_per_mm;
  std::vector<int> columns;
  std::vector<float> before, after;
};

/// The voxels that a ball would lower: those that it overlaps and that are not cut yet. The half of the ball
/// ahead of its centre (leading) is shifted along `ahead`; the other half (trailing) stays in place.
class CutVoxels {
 public:
  /// Allocates for at most `voxels` voxels and `rows` rows per step.
  CutVoxels(const GridGeometry& geometry, std::size_t voxels, std::size_t rows);

  /// Gathers, from the pieces in `reach`, the voxels that the ball lowers if its leading half is
  /// `max_ahead_mm` ahead. Marks empty voxels in `reach`.
  void gather(BurrReach& reach, const CuttingBall& ball, const CutProfile& profile,
              double max_ahead_mm) noexcept;

  /// Cost of cutting to the ball's surface, as sums of density drops.
  struct Cost {
    double leading = 0;
    /// Derivative of `leading` with respect to the distance ahead.
    double slope_per_mm = 0;
    double trailing = 0;
  };
  Cost cost(double ahead_mm) const noexcept;

  /// Fraction of each drop that is applied.
  struct Shares {
    double leading = 1;
    double trailing = 1;
  };
  /// Fills `after()`. Returns the sum of the drops, computed from the stored floats without further rounding.
  double find_lowered(double ahead_mm, const Shares& shares) noexcept;

  /// The voxels of a row are entries [begin, end) of the lists below.
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
  // Along each axis: distance of each plane of voxels from the ball's centre.
  std::array<std::vector<float>, 3> from_centre_mm_;
};

/// Distance by which the leading half of the ball is shifted, and the fraction of each drop that is applied.
struct BurrAdvance {
  double ahead_mm = 0;
  CutVoxels::Shares shares;
  /// `CutVoxels::Cost::slope_per_mm` at `ahead_mm`.
  double slope_per_mm = 0;
};

/// Returns the advance between `min_ahead_mm` and `max_ahead_mm` at which cutting to the ball's surface costs
/// `budget` (a sum of densities, above 0). The search starts at `start_ahead_mm`. The trailing half is paid
/// for first, with at most half the budget. If even `min_ahead_mm` costs more, each drop is applied in part,
/// so that the budget is not exceeded except by float rounding. Safe in the haptic tick.
BurrAdvance advance_within(double budget, const CutVoxels& voxels, double start_ahead_mm, double min_ahead_mm,
                           double max_ahead_mm) noexcept;

}  // namespace osteomill
