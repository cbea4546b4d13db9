#pragma once

#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// Isovalue of the surface of `builtin_tooth`.
inline constexpr double kBuiltinToothIsovalue = 750.0;

/// Returns a synthetic molar, for use without a scan: a crown with fissures and an enamel cap, dentine, a
/// pulp chamber with canals, and two roots. 256 x 256 x 176 voxels of 0.125 mm, crown towards +z, edges
/// blurred as in a CT scan. Densities are HU-like: surroundings 0, pulp 40, dentine 1500, enamel 2800.
/// `refinement` divides the spacing and multiplies the dims (2 gives 512 x 512 x 352); the tooth keeps its
/// size. Throws std::invalid_argument unless `refinement` is from 0.1 to 8.
DensityGrid builtin_tooth(double refinement = 1.0);

}  // namespace osteomill
