#pragma once

#include "osteomill/volume/density_grid.h"

// Scans that hold labels in the place of densities.
namespace osteomill {

/// The guess at a grid's values: densities, labels, or either.
enum class LabelGuess { densities, unclear, labels };

/// Guesses whether a grid holds labels: few small whole numbers from 0 up, 0 the commonest, that are no
/// levels of one quantity. Levels lie between their neighbours wherever there is an edge, and hardly ever
/// touch any but the next level, whereas structures touch any that they lie beside. Values count by how many
/// voxels have them, so that a few stray voxels of one decide nothing. Structures that lie in each other like
/// the skins of an onion look like levels, so fewer than 33 values that are not taken for labels are unclear.
/// Passes over the voxels; not for the tick.
LabelGuess guess_labels(const DensityGrid& grid);

/// Returns an isovalue between the two lowest labels (if there are two), so that every labelled voxel is
/// bone. Passes over the voxels; not for the tick.
double isovalue_of_labels(const DensityGrid& grid);

/// Turns a grid of labels into one of densities, since labels are no quantities: every voxel whose label is
/// above the isovalue gets the isovalue plus 0.5, every other one the isovalue less 0.5. Passes over the
/// voxels; not for the tick.
DensityGrid bone_of_labels(const DensityGrid& labels, double isovalue);

}  // namespace osteomill
