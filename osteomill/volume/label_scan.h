#pragma once

#include <optional>

#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// Where a grid holds labels in the place of densities (few whole numbers, most of which
/// occur in pieces rather than strewn): the isovalue between the two lowest, at which all that is labelled is
/// bone. Nothing for a grid of densities. At most a pass over the voxels.
std::optional<double> isovalue_of_labels(const DensityGrid& grid);

/// A grid of labels as one of densities, since labels are no quantities: those above the isovalue are all as
/// dense as each other, half above it, and the others half below.
DensityGrid bone_of_labels(const DensityGrid& labels, double isovalue);

}  // namespace osteomill
