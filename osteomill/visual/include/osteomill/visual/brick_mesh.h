#pragma once

#include <array>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "osteomill/base/pose.h"

namespace osteomill {

/// One corner of the isosurface's triangles, laid out so that it can be handed to a graphics card as it is.
struct MeshVertex {
  /// The position in W.
  std::array<float, 3> position_mm;
  /// The normal in W, of unit length, out of the bone: against the density's gradient, averaged over about a
  /// voxel to all sides, so that voxels do not show as terraces.
  std::array<float, 3> normal;
  /// The density of the bone just under the surface, to colour it by: a mean over about a voxel around the
  /// place a voxel below it, in which denser voxels count more, because less dense ones may be half air.
  float density;
  friend bool operator==(const MeshVertex&, const MeshVertex&) = default;
};
static_assert(sizeof(MeshVertex) == 28 && std::is_trivially_copyable_v<MeshVertex>);

/// Returns three floats of a vertex as a vector.
inline Vec3 vec3_of(const std::array<float, 3>& numbers) {
  return Eigen::Map<const Eigen::Vector3f>(numbers.data()).cast<double>();
}
/// Writes a vector into three floats of a vertex.
inline void put(const Vec3& vector, std::array<float, 3>& numbers) {
  Eigen::Map<Eigen::Vector3f>(numbers.data()) = vector.cast<float>();
}

/// A piece of the isosurface as indexed triangles: three indices each, anticlockwise seen from outside the
/// bone. Vertices are shared within a piece; where pieces meet, both have the same vertices, bit for bit.
struct BrickMesh {
  std::vector<MeshVertex> vertices;
  std::vector<std::uint32_t> indices;

  bool empty() const { return indices.empty(); }
  std::size_t triangle_count() const { return indices.size() / 3; }
  friend bool operator==(const BrickMesh&, const BrickMesh&) = default;
};

}  // namespace osteomill
