#pragma once

#include <array>
#include <vector>

#include "osteomill/volume/volume.h"

namespace osteomill {

/// How much of the space around a point is bone, at several scales: a pyramid of grids, each with cells twice
/// as wide as those of the one below. Tells a picture how much light comes from where.
class BoneShares {
 public:
  explicit BoneShares(const Volume& volume);

  /// The share, 0 to 1, of a soft-edged neighbourhood about `width_mm` wide that is bone (to the nearest of
  /// the pyramid's scales).
  double around(const Vec3& point_W, double width_mm) const;

  /// The share, 0 to 1, of a cone's light that reaches its apex: the cone opens along the unit vector
  /// `direction_W`, its width growing by `width_per_mm`, as far as `reach_mm`.
  double clear_share(const Vec3& apex_W, const Vec3& direction_W, double width_per_mm, double reach_mm) const;

 private:
  struct Level {
    std::array<int, 3> dims;
    std::vector<float> shares;
    double at(int i, int j, int k) const;
    double interpolated(const Vec3& cell) const;
  };
  static Level finest(const Volume& volume);
  static Level halved(const Level& finer);

  GridGeometry geometry_;
  double spacing_mm_;
  std::vector<Level> levels_;
};

}  // namespace osteomill
