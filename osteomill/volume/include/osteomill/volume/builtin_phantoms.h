#pragma once

#include <span>
#include <string_view>

#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// Synthetic bone for exercises. Densities are HU-like; edges are blurred as in a CT scan.
struct BuiltinPhantom {
  std::string_view name;
  double isovalue = 0;
  DensityGrid (*make)() = nullptr;
};

/// Returns all built-in phantoms:
/// - `layers`: 24 x 24 x 12 mm of bone with a flat surface at z = 0: 2 mm of hard bone, 3 mm of soft bone, 1
///   mm of hard bone, and soft bone below. 0.25 mm voxels.
/// - `mastoid`: 26 x 30 x 24 mm of temporal bone, lateral side towards +z, with a 2 mm cortex, air cells and
///   an antrum. Facial nerve, sigmoid sinus and dura are soft tissue, each under 1.3 mm of solid bone
///   (positions: docs/exercises.md). 0.25 mm voxels.
std::span<const BuiltinPhantom> builtin_phantoms();

}  // namespace osteomill
