#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "osteomill/surface/brick_mesh.h"
#include "osteomill/surface/density_handover.h"
#include "osteomill/surface/surface_bricks.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// A brick of `SurfaceBricks` whose triangles are no longer what they were; it may have none now.
struct ChangedBrick {
  std::size_t brick;
  BrickMesh mesh;
};

/// A copy of a volume's densities (4 bytes a voxel) that follows the volume's milling, and knows which bricks
/// of its surface have to be meshed anew. For one thread.
class SurfaceCopy {
 public:
  /// At first every brick has to be meshed.
  explicit SurfaceCopy(const Volume& volume);

  const SurfaceBricks& layout() const { return layout_; }
  /// Takes densities over, none of which has risen.
  void put(const DensityHandover::Brick& brick);
  /// After another isovalue every brick has to be meshed.
  void set_isovalue(double isovalue);
  /// Meshes the bricks that have to be, and returns those that have triangles or had some before.
  std::vector<ChangedBrick> remesh();

 private:
  VoxelBox take_over(const DensityHandover::Brick& brick);
  void mark(const VoxelBox& bricks);
  void mark_all();

  DensityGrid grid_;
  BrickRanges ranges_;
  double isovalue_;
  SurfaceBricks layout_;
  std::vector<std::uint8_t> marked_;    // by brick: has to be meshed
  std::vector<std::size_t> to_mesh_;    // those marked
  std::vector<std::uint8_t> has_mesh_;  // by brick: has triangles
};

}  // namespace osteomill
