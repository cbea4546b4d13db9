#include "osteomill/haptics/sample_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace osteomill {

std::vector<Vec3> centreline_vertices(const MillingTool& tool, int count) {
  if (count < 1) throw std::invalid_argument("the centreline needs at least 1 vertex");
  std::vector<Vec3> vertices{Vec3::Zero()};
  vertices.reserve(static_cast<std::size_t>(count));
  for (int n = 1; n < count; ++n) {
    vertices.emplace_back(0, 0, tool.shaft_length_mm * n / (count - 1));
  }
  return vertices;
}

std::array<Vec3, kSphereVertices> sphere_vertices(const MillingTool& tool) {
  // The tribonacci constant, the real root of t^3 = t^2 + t + 1.
  constexpr double t = 1.8392867552141612;
  const Vec3 size(1, 1 / t, t);
  const double scale = tool.burr_radius_mm / size.norm();
  std::array<Vec3, kSphereVertices> vertices;
  std::size_t n = 0;
  for (int signs = 0; signs < 8; ++signs) {
    Vec3 corner = scale * size;
    int pluses = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const bool plus = (signs >> axis) & 1;
      pluses += plus;
      if (!plus) corner[axis] *= -1;
    }
    // Even permutations with an even number of plus signs, odd ones with an odd number.
    if (pluses % 2 == 1) std::swap(corner.x(), corner.y());
    for (int turn = 0; turn < 3; ++turn) {
      vertices[n++] = corner;
      corner = Vec3(corner.y(), corner.z(), corner.x());
    }
  }
  return vertices;
}

std::vector<Vec3> spiral_directions(int count) {
  const double golden_rad = std::numbers::pi * (3 - std::sqrt(5.0));
  std::vector<Vec3> directions;
  for (int n = 0; n < count; ++n) {
    const double z = 1 - (2.0 * n + 1) / count;
    const double across = std::sqrt(1 - z * z);
    directions.emplace_back(across * std::cos(golden_rad * n), across * std::sin(golden_rad * n), z);
  }
  return directions;
}

std::vector<Vec3> sphere_vertices(const MillingTool& tool, int count) {
  if (count < 1) throw std::invalid_argument("the sphere needs at least 1 vertex");
  if (count == kSphereVertices) {
    const auto snub_cube = sphere_vertices(tool);
    return {snub_cube.begin(), snub_cube.end()};
  }
  std::vector<Vec3> vertices = spiral_directions(count);
  // Converged by then for any count: the push on a displaced vertex grows with count^1.5.
  constexpr int kRounds = 200;
  const double step = 2 / std::pow(count, 1.5);
  std::vector<Vec3> pushes(vertices.size());
  for (int round = 0; round < kRounds; ++round) {
    std::fill(pushes.begin(), pushes.end(), Vec3::Zero());
    for (std::size_t a = 0; a < vertices.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const Vec3 apart = vertices[a] - vertices[b];
        const Vec3 push = apart / (apart.squaredNorm() * apart.norm());
        pushes[a] += push;
        pushes[b] -= push;
      }
    }
    for (std::size_t n = 0; n < vertices.size(); ++n)
      vertices[n] = (vertices[n] + step * pushes[n]).normalized();
  }
  for (Vec3& vertex : vertices) vertex *= tool.burr_radius_mm;
  return vertices;
}

double shaft_start_mm(const MillingTool& tool) {
  const double leaves_burr = std::sqrt(
      std::max(0.0, tool.burr_radius_mm * tool.burr_radius_mm - tool.shaft_radius_mm * tool.shaft_radius_mm));
  return std::min(leaves_burr, tool.shaft_length_mm);
}

std::vector<ShaftSlice> slice_vertices(const MillingTool& tool, int slices, int vertices) {
  if (slices < 1 || vertices < 1) throw std::invalid_argument("the shaft needs at least 1 slice of 1 vertex");
  const double start = shaft_start_mm(tool);
  const double length = tool.shaft_length_mm - start;
  std::vector<ShaftSlice> result;
  if (length <= 0) return result;
  result.reserve(static_cast<std::size_t>(slices));
  for (int s = 0; s < slices; ++s) {
    ShaftSlice slice;
    slice.centre_T = Vec3(0, 0, start + length * (s + 0.5) / slices);
    for (int n = 0; n < vertices; ++n) {
      const double angle = 2 * std::numbers::pi * n / vertices;
      slice.vertices_T.emplace_back(slice.centre_T +
                                    tool.shaft_radius_mm * Vec3(std::cos(angle), std::sin(angle), 0));
    }
    result.push_back(std::move(slice));
  }
  return result;
}

}  // namespace osteomill
