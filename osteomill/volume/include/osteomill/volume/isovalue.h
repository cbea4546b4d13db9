#pragma once

#include <array>
#include <string>
#include <vector>

#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// Density boundary between one material of a scan and a denser one.
struct Boundary {
  /// Density at which the boundary is sharpest: an isovalue for the denser material.
  double density = 0;
  /// Densities of the materials on either side, taken at voxels that differ least from their neighbours.
  double below = 0;
  double above = 0;
  /// True if the suggested isovalue belongs to this boundary (suggest_isovalue); it rarely equals `density`.
  bool is_suggested = false;
};

/// Returns the boundaries between materials in ascending density: the local maxima of the mean gradient along
/// the isosurface (contour spectrum; Bajaj, Pascucci and Schikore 1997). Omits a maximum less than a tenth
/// above the higher of its neighbouring minima, one with less than a hundredth of the largest isosurface's
/// area, and a step on which no voxel lies, as between the values of a synthetic scan. Samples about four
/// million voxels at most. Not for the tick.
std::vector<Boundary> boundaries_in(const DensityGrid& grid);

/// Suggested isovalue, with a phrase for the user on how it was found.
struct SuggestedIsovalue {
  double value = 0;
  std::string how;
  /// The scan's boundaries. If any other than the isovalue's own was found, `how` calls the isovalue a guess.
  std::vector<Boundary> boundaries{};
};

/// Lowest value counted as bone, in Hounsfield units: between the 226 HU of InVesalius and Mimics and the 300
/// HU usual for compact bone.
inline constexpr double kBone_HU = 260;

/// Suggests an isovalue for the bone, depending on the densities:
/// - for a scan of a body, whose two most common densities (air and soft tissue) are about 1000 apart: 260
///   HU, or if the file does not state Hounsfield units, 260 above water, which is 40 below soft tissue;
/// - otherwise halfway between the most common densities of the bone and its surroundings (half-maximum
///   height; Spoor et al. 1993), but in Hounsfield units never below 260. The most common densities are found
///   on either side of Otsu's threshold (1979), among voxels that differ little from their neighbours, so
///   that blurred edges do not count (Panda and Rosenfeld 1978). `how` calls the result a guess if the scan
///   has other boundaries, or if its boundary is sharpest far from halfway. The result is strictly between
///   the grid's lowest and highest density, or equal to both if all densities are the same. Samples about
///   four million voxels at most. Not for the tick.
SuggestedIsovalue suggest_isovalue(const DensityGrid& grid, bool in_hounsfield_units = false);

/// Returns whether the isovalue leaves some voxels inside and some outside the bone. Passes over the voxels;
/// not for the tick.
bool is_within(const DensityGrid& grid, double isovalue);

/// Returns warnings for the user of this isovalue, one sentence each: it is outside the range of the
/// densities, so that none or all of the volume is bone; or bone touches the border of the volume, where it
/// is cut off and its interior exposed. One pass over the voxels.
std::vector<std::string> isovalue_warnings(const DensityGrid& grid, double isovalue);

/// Histogram for choosing the isovalue: log(1 + count) per bin, without the rarest densities at both ends.
struct DensityHistogram {
  float min = 0;
  float max = 1;
  std::array<float, 128> log_counts{};
};
/// Returns the histogram of a sample of up to about a million of the grid's voxels. Not for the tick.
DensityHistogram histogram_of(const DensityGrid& grid);

}  // namespace osteomill
