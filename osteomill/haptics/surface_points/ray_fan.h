#pragma once

#include <array>
#include <span>
#include <vector>

#include "osteomill/volume/volume.h"

namespace osteomill::surface_points {

/// Directions from one centre, and which of them lie side by side.
struct RayFan {
  static constexpr std::size_t kMaxRays = 64;
  /// Unit vectors, at most `kMaxRays`.
  std::vector<Vec3> directions;
  std::vector<std::vector<std::size_t>> neighbours;
};

/// The fan with the neighbours that lie no further apart than `angle_rad`. Throws std::invalid_argument where
/// there are too many directions. Allocates.
RayFan make_ray_fan(std::vector<Vec3> directions, double angle_rad);

/// Where bone is met along the rays of a fan, as distances from its centre (mm; infinite where it is not).
using RayDistances = std::array<double, RayFan::kMaxRays>;

/// The direction from the centre to the nearest point of a surface that ray `n` and its neighbours meet,
/// taken to be flat there: 1 / distance is then linear in the direction. With one ray met, that ray. An
/// `axis` other than zero (a unit vector) keeps the answer across it. Safe in the haptic tick.
Vec3 nearest_direction(std::span<const Vec3> directions, const RayFan& fan, const RayDistances& distance_mm,
                       std::size_t n, const Vec3& axis);

}  // namespace osteomill::surface_points
