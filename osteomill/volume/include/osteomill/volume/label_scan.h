#pragma once

#include "osteomill/volume/density_grid.h"

/// Scans that hold labels in the place of densities. Passes over the voxels; not for the tick.
namespace osteomill {

/// Whether a grid looks as if it held labels: few small whole numbers from 0 up, 0 the commonest, that are no
/// levels of one quantity. Levels lie between their neighbours wherever there is an edge, and hardly ever
/// touch any but the next level, where structures touch whatever they lie beside. A guess: structures that
/// lie in each other like the skins of an onion look like levels.
bool looks_like_labels(const DensityGrid& grid);

/// Between the two lowest labels (where there are two), so that whatever is labelled is bone.
double isovalue_of_labels(const DensityGrid& grid);

/// A grid of labels as one of densities, since labels are no quantities: every voxel whose label is above the
/// isovalue gets the isovalue plus 0.5, every other one the isovalue less 0.5.
DensityGrid bone_of_labels(const DensityGrid& labels, double isovalue);

}  // namespace osteomill
