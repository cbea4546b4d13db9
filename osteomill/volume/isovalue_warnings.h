#pragma once

#include <string>
#include <vector>

#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// Whether there are both bone and something else by this isovalue.
bool is_within(const DensityGrid& grid, double isovalue);

/// What a user of this isovalue should know, a sentence each: that it lies outside the grid's densities, so
/// that there is no bone or nothing else; or that bone touches the border of the volume, where it is cut off
/// and its inside lies open. One pass over the voxels.
std::vector<std::string> isovalue_warnings(const DensityGrid& grid, double isovalue);

}  // namespace osteomill
