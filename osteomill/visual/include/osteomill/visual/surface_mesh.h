#pragma once

#include <cstddef>

#include "osteomill/visual/brick_mesh.h"
#include "osteomill/visual/surface_bricks.h"
#include "osteomill/volume/block_ranges.h"
#include "osteomill/volume/density_grid.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// The densities that a surface is made from, their ranges brick by brick, and the isovalue at which bone
/// begins. Refers to densities and ranges, which outlive it.
struct DensityView {
  const DensityGrid& grid;
  const BlockRanges& ranges;
  /// There is bone where the density is greater. It may be any value, whatever the volume's own isovalue.
  double isovalue;

  DensityView(const DensityGrid& grid_, const BlockRanges& ranges_, double isovalue_)
      : grid(grid_), ranges(ranges_), isovalue(isovalue_) {}
  explicit DensityView(const Volume& volume)
      : DensityView(volume.grid(), volume.ranges(), volume.isovalue()) {}
};

/// Makes the isosurface within one brick of `SurfaceBricks(view.grid.geometry().dims)`, by Marching Cubes
/// (Lorensen and Cline 1987) with one rule for ambiguous faces, so that the bricks together are closed: each
/// edge of a triangle belongs to one other, which runs along it the other way. Beyond the grid is no bone.
/// Not for the tick; any thread that may read the grid.
BrickMesh mesh_brick(const DensityView& view, std::size_t brick);

/// Makes the whole surface as one piece: vertices shared everywhere, so that it is closed by its indices
/// alone.
BrickMesh mesh_in_one_piece(const DensityView& view);

}  // namespace osteomill
