#include "osteomill/haptics/surface_points/ray_fan.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

namespace osteomill::surface_points {
namespace {

RayFan hedgehog() {
  std::vector<Vec3> directions;
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      for (int k = -1; k <= 1; ++k) {
        if (i != 0 || j != 0 || k != 0) directions.emplace_back(Vec3(i, j, k).normalized());
      }
    }
  }
  return make_ray_fan(directions, 0.8);
}

RayDistances distances_to_plane(const RayFan& fan, const Vec3& normal, double distance_mm) {
  RayDistances distances;
  distances.fill(std::numeric_limits<double>::infinity());
  for (std::size_t n = 0; n < fan.directions.size(); ++n) {
    const double towards = fan.directions[n].dot(normal);
    if (towards > 0.3) distances[n] = distance_mm / towards;
  }
  return distances;
}

TEST(RayFan, OnAPlaneTheNearestDirectionIsItsNormal) {
  const RayFan fan = hedgehog();
  for (const Vec3& normal : {Vec3(0.1, 0.2, 1), Vec3(-0.5, 0.3, 0.4), Vec3(1, 1, 0.9)}) {
    const Vec3 n = normal.normalized();
    const RayDistances distances = distances_to_plane(fan, n, 1.3);
    std::size_t min = 0;
    for (std::size_t m = 0; m < fan.directions.size(); ++m) {
      if (distances[m] < distances[min]) min = m;
    }
    const Vec3 nearest = nearest_direction(fan.directions, fan, distances, min, Vec3::Zero());
    EXPECT_LT((nearest - n).norm(), 1e-3);
  }
}

TEST(RayFan, WithOneRayMetItIsThatRay) {
  const RayFan fan = hedgehog();
  RayDistances distances;
  distances.fill(std::numeric_limits<double>::infinity());
  distances[5] = 2;
  EXPECT_LT((nearest_direction(fan.directions, fan, distances, 5, Vec3::Zero()) - fan.directions[5]).norm(),
            1e-9);
}

TEST(RayFan, AnAxisKeepsItAcross) {
  std::vector<Vec3> around;
  for (int n = 0; n < 8; ++n) {
    around.emplace_back(std::cos(n * std::numbers::pi / 4), std::sin(n * std::numbers::pi / 4), 0);
  }
  const RayFan fan = make_ray_fan(around, 0.9);
  ASSERT_EQ(fan.neighbours[3].size(), 2u);
  const Vec3 normal = Vec3(0.9, 0.3, 0.5).normalized();
  const Vec3 nearest =
      nearest_direction(fan.directions, fan, distances_to_plane(fan, normal, 1), 0, Vec3::UnitZ());
  EXPECT_LT((nearest - Vec3(normal.x(), normal.y(), 0).normalized()).norm(), 1e-3);
}

TEST(RayFan, TooManyRaysAreRefused) {
  EXPECT_THROW(make_ray_fan(std::vector<Vec3>(RayFan::kMaxRays + 1, Vec3::UnitX()), 1),
               std::invalid_argument);
}

}  // namespace
}  // namespace osteomill::surface_points
