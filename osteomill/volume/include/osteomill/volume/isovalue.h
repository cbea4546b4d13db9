#pragma once

#include <array>
#include <string>
#include <vector>

#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// A boundary, by density, at which one material of a scan ends and a denser one begins.
struct Boundary {
  /// The density at which the boundary is sharpest: an isovalue that bounds the denser material.
  double density = 0;
  /// The densities of the materials on either side, taken at voxels that differ least from their neighbours.
  double below = 0;
  double above = 0;
  /// True if the suggested isovalue lies on this boundary (suggest_isovalue), though rarely at the density at
  /// which it is sharpest.
  bool is_suggested = false;
};

/// Returns the boundaries between materials, by density: the local maxima of the mean gradient along the
/// isosurface, which is the contour spectrum of Bajaj, Pascucci and Schikore (1997). A maximum is left out if
/// it is less than a tenth sharper than the dip beside it, or has less than a hundredth of the largest
/// isosurface's area, or if no voxel lies on the step, as between the values of a made-up scan. Looks at some
/// four million voxels at the most. Not for the tick.
std::vector<Boundary> boundaries_in(const DensityGrid& grid);

/// An isovalue, and in half a sentence where it came from, for people to read.
struct SuggestedIsovalue {
  double value = 0;
  std::string how;
  /// The scan's boundaries. If there are several, `how` says that the isovalue is a guess among them.
  std::vector<Boundary> boundaries{};
};

/// The least value counted as bone, in Hounsfield units: between the 226 HU of InVesalius and Mimics and the
/// 300 HU that are usual for compact bone.
inline constexpr double kBone_HU = 260;

/// Suggests the isovalue that bounds the bone, by what the densities are:
/// - a scan of a body, which has its two commonest densities, air and soft tissue, 1000 apart: 260 HU, and
///   if the file does not say that it is in Hounsfield units, 260 above water, which lies 40 below soft
///   tissue;
/// - else halfway between the commonest density of the bone and of what is around it (half-maximum height;
///   Spoor et al. 1993), but in Hounsfield units never under 260.
/// Commonest is counted where densities hardly change from voxel to voxel, so not in blurred edges (Panda and
/// Rosenfeld 1978), on either side of the threshold of Otsu 1979. A guess, and said to be one, where the scan
/// has another boundary than the one on which it lies, or is sharpest elsewhere than halfway. Always strictly
/// between the grid's least and greatest density; where all are equal, that density. Looks at some four
/// million voxels at the most. Not for the tick.
SuggestedIsovalue suggest_isovalue(const DensityGrid& grid, bool in_hounsfield_units = false);

/// Returns whether there are both bone and something else at this isovalue. Goes through the grid; not for
/// the tick.
bool is_within(const DensityGrid& grid, double isovalue);

/// Returns what a user of this isovalue should know, a sentence each: that it lies outside the grid's
/// densities, so that there is no bone or nothing else; or that bone touches the border of the volume, where
/// it is cut off and its inside lies open. One pass over the voxels.
std::vector<std::string> isovalue_warnings(const DensityGrid& grid, double isovalue);

/// A histogram by which a user chooses the isovalue: logarithms of how often densities occur, over all
/// densities but the rarest at both ends.
struct DensityHistogram {
  float min = 0;
  float max = 1;
  std::array<float, 128> log_counts{};
};
/// Returns the histogram of some million of the grid's voxels. Not for the tick.
DensityHistogram histogram_of(const DensityGrid& grid);

}  // namespace osteomill
