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

/// Changed bricks of a `SurfaceBricks` layout, by number, with their new triangles, if any. While a brick is
/// being milled, all its levels equal its mesh (`full_detail`).
using ChangedBricks = std::map<std::size_t, BrickLevels>;

/// Keeps a surface up to date: tracks which bricks need remeshing, and remeshes them. Holds no densities. For
/// one thread.
class SurfaceUpkeep {
 public:
  /// Consecutive calls of `remesh` for which a brick must be unmarked before its levels are built: they take
  /// five times as long as its mesh and are not visible while the brick is milled.
  static constexpr int kCallsUntilRest = 10;
  /// Maximum bricks whose levels are built in one call.
  static constexpr std::size_t kMaxRefinedPerCall = 2;

  /// Marks every brick.
  explicit SurfaceUpkeep(const SurfaceBricks& layout);

  /// Marks the bricks that depend on these voxels (in the grid), whose densities changed in either direction.
  void mark(const VoxelBox& voxels);
  /// Marks every brick, e.g. after a change of isovalue.
  void mark_all();
  /// Meshes the marked bricks and returns those that have or had triangles; adds the levels of bricks that
  /// have come to rest.
  ChangedBricks remesh(const DensityView& view);

 private:
  SurfaceBricks layout_;
  std::set<std::size_t> to_mesh_;
  int calls_ = 0;                        // of remesh
  std::map<std::size_t, int> changing_;  // bricks not at rest, with the call before which they were marked
  std::vector<std::uint8_t> has_mesh_;   // by brick: has triangles
};

}  // namespace osteomill
