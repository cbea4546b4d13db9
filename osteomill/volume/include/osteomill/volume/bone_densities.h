#pragma once

#include "osteomill/volume/volume.h"

namespace osteomill {

/// The two densities between which milling is counted.
struct BoneDensities {
  /// The density of what lies around the bone, to which milling cuts bone down.
  double surroundings = 0;
  /// The density at which 1 mm^3 of bone costs 1 mm^3: typical bone (dentine in a tooth).
  double reference = 1;
};

/// Estimates both from the volume: `surroundings` is the median density of the voxels eight steps out of the
/// bone along an axis with no bone between (a scanner's blur and scatter reach about as far), `reference` the
/// median density of the bone. Without such voxels, the median of all that is not bone. Always reference >
/// isovalue > surroundings. Not for the tick.
BoneDensities estimate_densities(const Volume& volume);

}  // namespace osteomill
