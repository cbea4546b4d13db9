#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "osteomill/surface/brick_levels.h"
#include "osteomill/surface/brick_mesh.h"
#include "osteomill/surface/surface_bricks.h"
#include "osteomill/surface/surface_mesh.h"

namespace osteomill {

/// A brick of `SurfaceBricks` whose triangles are no longer what they were; it may have none now.
struct ChangedBrick {
  std::size_t brick;
  BrickMesh mesh;
  /// The mesh with fewer triangles, for drawing it.
  BrickLevels levels;
};

/// Which bricks of a surface have to be meshed anew as the densities change. Holds no densities. For one
/// thread.
class SurfaceUpkeep {
 public:
  /// At first every brick has to be meshed.
  explicit SurfaceUpkeep(const SurfaceBricks& layout);

  const SurfaceBricks& layout() const { return layout_; }
  /// Densities of these voxels (in the grid) changed, up or down.
  void mark(const VoxelBox& voxels);
  /// As after another isovalue.
  void mark_all();
  /// Meshes the bricks marked, and returns those that have triangles or had some before.
  std::vector<ChangedBrick> remesh(const DensityView& view);

 private:
  SurfaceBricks layout_;
  std::vector<std::uint8_t> marked_;    // by brick: has to be meshed
  std::vector<std::size_t> to_mesh_;    // those marked
  std::vector<std::uint8_t> has_mesh_;  // by brick: has triangles
};

}  // namespace osteomill
