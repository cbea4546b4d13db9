#pragma once

#include <string>

#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// An isovalue, and in half a sentence where it came from, for people to read.
struct SuggestedIsovalue {
  double value = 0;
  std::string how;
};

/// From where bone is counted in Hounsfield units: between the 226 HU of InVesalius and Mimics and the 300 HU
/// that are usual for compact bone.
inline constexpr double kBone_HU = 260;

/// The isovalue that bounds the bone, by what the densities are:
/// - a map of labels (few whole numbers, most of which occur in pieces): between the two lowest, so
///   that whatever is labelled is bone;
/// - a scan of a body, which has its two commonest densities, air and soft tissue, 1000 apart: 260 HU, and
///   where the file does not say that it is in Hounsfield units, 260 above water, which lies 40 below soft
///   tissue;
/// - else halfway between the commonest density of the bone and of what is around it (half-maximum height;
///   Spoor et al. 1993), but in Hounsfield units never under 260.
/// Commonest is counted where densities hardly change from voxel to voxel, so not in blurred edges (Panda and
/// Rosenfeld 1978), on either side of the threshold of Otsu 1979. Always strictly between the grid's least
/// and greatest density; where all are equal, that density. Looks at some four million voxels at the most.
/// Not for the tick.
SuggestedIsovalue suggest_isovalue(const DensityGrid& grid, bool in_hounsfield_units = false);

}  // namespace osteomill
