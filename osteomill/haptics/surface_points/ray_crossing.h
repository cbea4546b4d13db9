#pragma once

#include <optional>

#include "osteomill/volume/volume.h"

namespace osteomill::surface_points {

/// How far along the segment from `from_W`, which is not in bone, to `to_W` bone is first met, as a share in
/// [0, 1], to 0.0001 mm; nothing where it is not, or where `from_W` is in bone. The first `known_free_mm` are
/// taken to be free unless their end is in bone. Looks every half voxel, but no closer than every 0.045 mm:
/// what is thinner than that does not hold a tool, and in the finest scans most of the looks would be for it.
/// A third of the samples of `first_crossing`. Safe in the haptic tick.
std::optional<double> share_to_bone(const Volume& volume, const Vec3& from_W, const Vec3& to_W,
                                    double known_free_mm = 0);

}  // namespace osteomill::surface_points
