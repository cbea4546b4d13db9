#pragma once

#include <optional>

#include "osteomill/volume/volume.h"

namespace osteomill {

/// How far along the segment from `from_W`, which is not in bone, to `to_W` bone is first met, as a share in
/// [0, 1]; nothing where it is not, or where `from_W` is in bone. Steps of at most half a voxel, then regula
/// falsi to a thousandth of a step: a third of the samples of `first_crossing`. Safe in the haptic tick.
std::optional<double> share_to_bone(const Volume& volume, const Vec3& from_W, const Vec3& to_W);

}  // namespace osteomill
