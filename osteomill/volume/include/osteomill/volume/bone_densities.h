#pragma once

#include "osteomill/volume/volume.h"

namespace osteomill {

/// Densities by which removed volume is counted: a voxel lowered from `reference` to `surroundings` counts
/// fully, a denser one more.
struct BoneDensities {
  /// Density of the material around the bone; milling lowers bone to it.
  double surroundings = 0;
  /// Density of typical bone (dentine in a tooth).
  double reference = 1;
};

/// Estimates both from the volume. `reference` is the median density of the bone. `surroundings` is the
/// median density of the voxels eight steps outside the bone along an axis, with no bone in between (a
/// scanner's blur and scatter reach about that far), or without any such voxel the median of all that are not
/// bone. Always reference > isovalue > surroundings. Not for the tick.
BoneDensities estimate_densities(const Volume& volume);

}  // namespace osteomill
