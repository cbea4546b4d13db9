#pragma once

#include <vector>

#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// Where one material of a scan ends and a denser one begins.
struct Boundary {
  /// At which the boundary is sharpest: an isovalue that bounds the denser one.
  double density = 0;
  /// What lies on either side, where densities change least from voxel to voxel.
  double below = 0;
  double above = 0;
};

/// The boundaries between materials, by density: the local maxima of the mean gradient along the isosurface,
/// which is the contour spectrum of Bajaj, Pascucci and Schikore (1997). What is less than a tenth sharper
/// than what lies between two of them, or has less than a hundredth of the largest isosurface's area, is
/// none; so is a step without any voxel on it, as between the values of a made-up scan. Looks at some four
/// million voxels at the most. Not for the tick.
std::vector<Boundary> boundaries_in(const DensityGrid& grid);

}  // namespace osteomill
