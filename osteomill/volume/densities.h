#pragma once

#include "osteomill/volume/volume.h"

namespace osteomill {

/// The two densities between which milling is counted.
struct BoneDensities {
  /// What bone is cut down to: the density of what lies around it.
  double surroundings = 0;
  /// The density at which 1 mm^3 of bone costs 1 mm^3: typical bone (dentine in a tooth).
  double reference = 1;
};

/// Estimates both from the volume: `surroundings` is the median density just outside the surface (voxels
/// three steps away from bone along an axis), `reference` the median density of the bone. Always reference >
/// isovalue > surroundings.
BoneDensities estimate_densities(const Volume& volume);

/// The isovalue that best separates the grid's densities into two classes (Otsu 1979), strictly between its
/// least and greatest density; where all densities are equal, that density.
double suggest_isovalue(const DensityGrid& grid);

}  // namespace osteomill
