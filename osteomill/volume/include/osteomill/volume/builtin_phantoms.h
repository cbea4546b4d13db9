#pragma once

#include <span>
#include <string_view>

#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// A made-up bone for exercises. Densities are HU-like, edges as soft as a scanner leaves them.
struct BuiltinPhantom {
  std::string_view name;
  double isovalue = 0;
  DensityGrid (*make)() = nullptr;
};

/// Returns all of them:
/// - `layers`: 24 x 24 x 12 mm of bone with a flat surface at z = 0: 2 mm of hard bone, 3 mm of soft bone, 1
/// mm
///   of hard bone, and soft bone below. Voxels of 0.25 mm.
/// - `mastoid`: 26 x 30 x 24 mm of temporal bone seen from its side, outward along +z, with a cortex of 2 mm,
///   air cells and an antrum, and as soft tissue a facial nerve, a sigmoid sinus and the dura
///   (docs/exercises.md has their places), each under 1.3 mm of solid bone. Voxels of 0.25 mm.
std::span<const BuiltinPhantom> builtin_phantoms();

}  // namespace osteomill
