#pragma once

#include "osteomill/volume/density_grid.h"

// Scans that hold labels instead of densities.
namespace osteomill {

/// Guess at what a grid's values are; `unclear` means either.
enum class LabelGuess { densities, unclear, labels };

/// Guesses whether a grid holds labels: a few small whole numbers from 0 up, 0 the most common, that are not
/// levels of one quantity. At an edge, a level lies between its neighbours and hardly ever touches any but
/// the next level, whereas structures touch any others. Values are weighted by voxel count, so that a few
/// stray voxels do not matter. Nested structures, like the skins of an onion, look like levels; therefore a
/// grid of fewer than 33 values, 0 the most common, is `unclear` if it is not taken for labels. Passes over
/// the voxels; not for the tick.
LabelGuess guess_labels(const DensityGrid& grid);

/// Returns the isovalue halfway between the two lowest values (the value itself if there is only one), so
/// that every labelled voxel is bone. Passes over the voxels; not for the tick.
double isovalue_of_labels(const DensityGrid& grid);

/// Converts a grid of labels, which are not quantities, into densities: a voxel whose label is above the
/// isovalue gets the isovalue plus 0.5, any other the isovalue minus 0.5. Passes over the voxels; not for the
/// tick.
DensityGrid bone_of_labels(const DensityGrid& labels, double isovalue);

}  // namespace osteomill
