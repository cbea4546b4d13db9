#include "osteomill/haptics/surface_points/ray_fan.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <Eigen/LU>

namespace osteomill::surface_points {

namespace {

// Pulls an answer that too few rays decide to the ray itself.
constexpr double kPrior = 1e-3;

}  // namespace

RayFan make_ray_fan(std::vector<Vec3> directions, double angle_rad) {
  if (directions.size() > RayFan::kMaxRays) throw std::invalid_argument("surface-points: too many rays");
  RayFan fan;
  fan.directions = std::move(directions);
  fan.neighbours.resize(fan.directions.size());
  for (std::size_t n = 0; n < fan.directions.size(); ++n) {
    for (std::size_t m = 0; m < fan.directions.size(); ++m) {
      if (m != n && fan.directions[n].dot(fan.directions[m]) > std::cos(angle_rad)) {
        fan.neighbours[n].push_back(m);
      }
    }
  }
  return fan;
}

Vec3 nearest_direction(std::span<const Vec3> directions, const RayFan& fan, const RayDistances& distance_mm,
                       std::size_t n, const Vec3& axis) {
  const Vec3& own = directions[n];
  Mat3 squares = own * own.transpose() + kPrior * Mat3::Identity() + axis * axis.transpose();
  Vec3 sums = (1 + kPrior) / distance_mm[n] * own;
  for (const std::size_t m : fan.neighbours[n]) {
    if (!std::isfinite(distance_mm[m])) continue;
    squares += directions[m] * directions[m].transpose();
    sums += directions[m] / distance_mm[m];
  }
  const Vec3 inverse_distance = squares.inverse() * sums;
  return inverse_distance.normalized();
}

}  // namespace osteomill::surface_points
