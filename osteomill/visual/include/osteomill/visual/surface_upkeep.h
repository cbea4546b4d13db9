#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "osteomill/visual/brick_levels.h"
#include "osteomill/visual/brick_mesh.h"
#include "osteomill/visual/surface_bricks.h"
#include "osteomill/visual/surface_mesh.h"

namespace osteomill {

/// Bricks of `SurfaceBricks`, by their numbers, whose triangles have changed, with the new ones; a brick may
/// have none. While a brick is being milled all its levels are its mesh (`full_detail`).
using ChangedBricks = std::map<std::size_t, BrickLevels>;

/// Keeps a surface up with changing densities: notes which bricks are to be meshed again, and meshes them.
/// Holds no densities. For one thread.
class SurfaceUpkeep {
 public:
  /// The number of calls of `remesh` in a row that find a brick unmarked before its levels are made: making
  /// them takes five times as long as its mesh, and while the brick is milled they are not seen.
  static constexpr int kCallsUntilRest = 10;
  /// The most bricks whose levels are made in one call.
  static constexpr std::size_t kMaxRefinedPerCall = 2;

  /// Marks every brick, because none is meshed yet.
  explicit SurfaceUpkeep(const SurfaceBricks& layout);

  /// Marks the bricks that depend on these voxels (in the grid), whose densities changed, up or down.
  void mark(const VoxelBox& voxels);
  /// Marks every brick, as after another isovalue.
  void mark_all();
  /// Meshes the bricks marked, and returns those that have triangles or had some before; bricks that rest,
  /// once more with their levels.
  ChangedBricks remesh(const DensityView& view);

 private:
  SurfaceBricks layout_;
  std::set<std::size_t> to_mesh_;
  int calls_ = 0;                        // of remesh
  std::map<std::size_t, int> changing_;  // bricks that do not rest, with the call before they were marked
  std::vector<std::uint8_t> has_mesh_;   // by brick: has triangles
};

}  // namespace osteomill
