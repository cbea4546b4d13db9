#pragma once

#include <cstddef>

#include "osteomill/visual/brick_mesh.h"
#include "osteomill/visual/surface_bricks.h"
#include "osteomill/volume/block_ranges.h"
#include "osteomill/volume/density_grid.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// What a surface is made from: densities, their ranges brick by brick, and where bone begins. Refers to
/// both.
struct DensityView {
  const DensityGrid& grid;
  const BlockRanges& ranges;
  /// Bone where the density is greater. The surface may be asked for at any, whatever the volume's own.
  double isovalue;

  DensityView(const DensityGrid& grid_, const BlockRanges& ranges_, double isovalue_)
      : grid(grid_), ranges(ranges_), isovalue(isovalue_) {}
  explicit DensityView(const Volume& volume)
      : DensityView(volume.grid(), volume.ranges(), volume.isovalue()) {}
};

/// The isosurface within one brick of `SurfaceBricks(view.grid.geometry().dims)`, by Marching Cubes (Lorensen
/// and Cline 1987) with one rule for ambiguous faces, so that the bricks together are closed: each edge of a
/// triangle belongs to one other, which runs along it the other way. Beyond the grid is no bone. Not for the
/// tick; any thread that may read the grid.
BrickMesh mesh_brick(const DensityView& view, std::size_t brick);

/// The whole surface as one piece: vertices shared everywhere, so that it is closed by its indices alone.
BrickMesh mesh_in_one_piece(const DensityView& view);

}  // namespace osteomill
