#pragma once

#include <cstddef>
#include <vector>

#include "osteomill/geometry/pose.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// The voxels that a ball overlaps and that are denser than a floor, found anew each step at little cost: a
/// voxel that was in reach the step before and held nothing is not looked at again, so that a step costs the
/// rows of the ball and the voxels it finds, not all voxels of the ball. Voxels are found row by row (i runs
/// along a row), rows in order of k, then j.
class BurrReach {
 public:
  /// Allocates all that `find` needs. `radius_mm` is above 0, the grid not empty.
  BurrReach(const GridGeometry& geometry, double radius_mm, float floor_density);

  /// Finds what the ball about `centre_W` (finite) overlaps. Safe in the haptic tick.
  void find(const Volume& volume, const Vec3& centre_W);
  /// Has the next `find` look at every voxel.
  void forget() { known_volume_ = nullptr; }

  /// A row's voxels are [begin, end) of the lists below.
  struct Row {
    int j;
    int k;
    std::size_t begin;
    std::size_t end;
  };
  const std::vector<Row>& rows() const { return found_.rows; }
  std::size_t size() const { return found_.size; }
  /// The most that can ever be found.
  std::size_t capacity() const { return densities_.size(); }
  /// Column of each voxel found.
  const int* columns() const { return found_.columns.data(); }
  /// How deep each one's centre lies in the ball, mm, at least 0.
  const float* depths_mm() const { return depths_mm_.data(); }
  /// Each one's density as found, above the floor.
  const float* densities() const { return densities_.data(); }

 private:
  /// Indices along one axis, both ends among them; none where last < first.
  struct Span {
    int first = 0;
    int last = -1;
  };
  /// What the last `find` found, and which voxels it looked at.
  struct Found {
    std::vector<Row> rows;
    std::vector<int> columns;
    std::size_t size = 0;
    std::vector<Span> looked_at;  // of each row of `box`, j running fastest
    Span js;
    Span ks;
  };

  Span span_within(double centre_mm, double half_width_mm, int axis) const;
  Span looked_at_before(int j, int k) const;
  void find_row(const float* densities, Span row, int j, int k, double across2);
  void look_at(const float* densities, Span columns);
  void look_again(const float* densities, Span columns, int j, int k);
  void measure_depths(double centre_i_mm);

  GridGeometry geometry_;
  Vec3 inverse_spacing_;
  double radius_mm_;
  float floor_density_;

  const Volume* known_volume_ = nullptr;
  std::size_t next_before_ = 0;  // the first of before_.rows that is not behind the row being found
  Found before_;
  Found found_;
  std::vector<float> across2_mm2_;
  std::vector<float> depths_mm_;
  std::vector<float> densities_;
};

}  // namespace osteomill
