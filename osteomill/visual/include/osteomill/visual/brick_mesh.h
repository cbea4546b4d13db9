#pragma once

#include <array>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "osteomill/base/pose.h"

namespace osteomill {

/// Vertex of the isosurface, laid out for upload to the graphics card.
struct MeshVertex {
  /// Position in W.
  std::array<float, 3> position_mm;
  /// Unit normal in W, pointing out of the bone: the negative density gradient, averaged over about a voxel
  /// in all directions, so that voxels do not show as terraces.
  std::array<float, 3> normal;
  /// Density of the bone just under the surface, for colouring: a mean over about a voxel around the point
  /// one voxel below the vertex, weighted towards denser voxels, because less dense ones may be partly air.
  float density;
  friend bool operator==(const MeshVertex&, const MeshVertex&) = default;
};
static_assert(sizeof(MeshVertex) == 28 && std::is_trivially_copyable_v<MeshVertex>);

/// Returns three floats of a vertex as a vector.
inline Vec3 vec3_of(const std::array<float, 3>& numbers) {
  return Eigen::Map<const Eigen::Vector3f>(numbers.data()).cast<double>();
}
/// Stores a vector as three floats of a vertex.
inline void put(const Vec3& vector, std::array<float, 3>& numbers) {
  Eigen::Map<Eigen::Vector3f>(numbers.data()) = vector.cast<float>();
}

/// Part of the isosurface as indexed triangles, anticlockwise seen from outside the bone. Vertices are shared
/// within a part; adjacent parts have bit-identical vertices on their common border.
struct BrickMesh {
  std::vector<MeshVertex> vertices;
  std::vector<std::uint32_t> indices;

  bool empty() const { return indices.empty(); }
  std::size_t triangle_count() const { return indices.size() / 3; }
  friend bool operator==(const BrickMesh&, const BrickMesh&) = default;
};

}  // namespace osteomill
