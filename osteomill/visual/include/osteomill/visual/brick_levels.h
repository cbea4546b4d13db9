#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "osteomill/visual/brick_mesh.h"
#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// Levels of detail of a brick's surface, for drawing it from afar or while it moves. Level 0 is the brick's
/// mesh. Level n has about one vertex per 2^n x 2^n x 2^n cells, at the intersection of the planes of the
/// mesh's triangles there, near the mean of its vertices (Lindstrom 2000; vertex clustering after Rossignac
/// and Borrel 1993, but only of connected vertices within a cell, so that the two sides of a thin wall stay
/// apart). Vertices on the brick's border do not move, so that bricks of different levels meet without gaps.
struct BrickLevels {
  static constexpr std::size_t kCount = 4;
  /// A range of indices.
  struct Range {
    std::size_t first = 0;
    std::size_t count = 0;
  };
  /// Vertices of the mesh, followed by those of levels 1 and up.
  std::vector<MeshVertex> vertices;
  /// Indices, three per triangle, those of level 0 first.
  std::vector<std::uint32_t> indices;
  /// Index range of each level.
  std::array<Range, kCount> levels{};

  bool empty() const { return levels[0].count == 0; }
};

/// Builds the levels of a brick's mesh. `cells` are the brick's cells (SurfaceBricks::cells). Not real-time
/// safe; any thread.
BrickLevels build_levels(const BrickMesh& mesh, const GridGeometry& geometry, const VoxelBox& cells);
/// Returns the mesh itself as every level.
BrickLevels full_detail(BrickMesh mesh);

}  // namespace osteomill
