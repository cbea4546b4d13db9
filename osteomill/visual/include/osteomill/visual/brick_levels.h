#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "osteomill/visual/brick_mesh.h"
#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// A brick's surface at four levels with fewer and fewer triangles, for drawing it from afar or while it
/// moves. Level 0 is the brick's mesh itself; level n has about one vertex for every 2^n x 2^n x 2^n cells,
/// where the planes of the mesh's triangles there meet, near the mean of its vertices (Lindstrom 2000; vertex
/// clustering after Rossignac and Borrel 1993, within a cell only what is connected, so that the two sides of
/// a thin wall stay two). Vertices on the brick's border stay as they are: bricks of any levels meet without
/// a gap.
struct BrickLevels {
  static constexpr std::size_t kCount = 4;
  /// A part of the indices.
  struct Range {
    std::size_t first = 0;
    std::size_t count = 0;
  };
  /// The vertices: first the mesh's own, then those of levels 1 and up.
  std::vector<MeshVertex> vertices;
  /// The indices, three a triangle, first all of level 0.
  std::vector<std::uint32_t> indices;
  /// The range of the indices that belong to each level.
  std::array<Range, kCount> levels{};

  bool empty() const { return levels[0].count == 0; }
};

/// Makes the levels of a brick's mesh. `cells` are the brick's, as SurfaceBricks names them. Not for the
/// tick; any thread.
BrickLevels levels_of(const BrickMesh& mesh, const GridGeometry& geometry, const VoxelBox& cells);
/// Returns the mesh itself at every level.
BrickLevels full_detail(BrickMesh mesh);

}  // namespace osteomill
