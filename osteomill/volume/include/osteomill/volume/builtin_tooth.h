#pragma once

#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// The isovalue that goes with `builtin_tooth`.
inline constexpr double kBuiltinToothIsovalue = 750.0;

/// Returns a made-up molar for when there is no scan: a crown with fissures and an enamel cap, dentine, a
/// pulp chamber with canals, and two roots. 256 x 256 x 176 voxels of 0.125 mm, crown towards +z, edges as
/// soft as a scanner leaves them. Densities are HU-like: surroundings 0, pulp 40, dentine 1500, enamel 2800.
/// `refinement` divides the spacing and multiplies the dims (2 gives 512 x 512 x 352), the same tooth.
DensityGrid builtin_tooth(double refinement = 1.0);

}  // namespace osteomill
