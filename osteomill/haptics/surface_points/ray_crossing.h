#pragma once

#include <optional>

#include "osteomill/volume/volume.h"

namespace osteomill::surface_points {

/// A straight way through the grid in continuous voxel coordinates: `origin + t * way`.
struct VoxelRay {
  Vec3 origin;
  Vec3 way;
};

/// Where, in [from, to], bone is first met along the ray; nothing where it is not, or where `from` is in
/// bone. Steps of at most half a voxel, then regula falsi to `tolerance` of a step. Safe in the haptic tick.
std::optional<double> first_bone(const Volume& volume, const VoxelRay& ray, double from, double to,
                                 double tolerance);

/// How far along the segment from `from_W`, which is not in bone, to `to_W` bone is first met, as a share in
/// [0, 1], to a thousandth of a step; nothing where it is not, or where `from_W` is in bone. The first
/// `known_free_mm` are taken to be free unless their end is in bone. A third of the samples of
/// `first_crossing`. Safe in the haptic tick.
std::optional<double> share_to_bone(const Volume& volume, const Vec3& from_W, const Vec3& to_W,
                                    double known_free_mm = 0);

}  // namespace osteomill::surface_points
