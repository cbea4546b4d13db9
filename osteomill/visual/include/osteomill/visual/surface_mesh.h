#pragma once

#include <cstddef>

#include "osteomill/visual/brick_mesh.h"
#include "osteomill/visual/surface_bricks.h"
#include "osteomill/volume/block_ranges.h"
#include "osteomill/volume/density_grid.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Input of surface extraction: densities, their per-brick ranges, and the isovalue. Holds references to
/// densities and ranges, which must outlive it.
struct DensityView {
  const DensityGrid& grid;
  const BlockRanges& ranges;
  /// Densities above this are bone. May differ from the volume's own isovalue.
  double isovalue;

  DensityView(const DensityGrid& grid_, const BlockRanges& ranges_, double isovalue_)
      : grid(grid_), ranges(ranges_), isovalue(isovalue_) {}
  explicit DensityView(const Volume& volume)
      : DensityView(volume.grid(), volume.ranges(), volume.isovalue()) {}
};

/// Extracts the isosurface within one brick of `SurfaceBricks(view.grid.geometry().dims)` by Marching Cubes
/// (Lorensen and Cline 1987). Ambiguous faces are resolved by one rule, so that the bricks together form a
/// closed surface: each triangle edge has one opposite edge in another triangle. Outside the grid there is no
/// bone. Not real-time safe; any thread that may read the grid.
BrickMesh mesh_brick(const DensityView& view, std::size_t brick);

/// Extracts the whole surface as one mesh with all vertices shared, so that it is closed by its indices
/// alone.
BrickMesh mesh_in_one_piece(const DensityView& view);

}  // namespace osteomill
