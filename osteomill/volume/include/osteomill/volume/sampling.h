#pragma once

#include <optional>
#include <span>

#include "osteomill/volume/density_grid.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Returns the trilinearly interpolated density at a point of W. Beyond the border voxels it falls to the
/// outside density within one voxel. Safe in the haptic tick.
double density_at(const DensityGrid& grid, const Vec3& point_W) noexcept;

/// Like `density_at`, at continuous voxel coordinates. Safe in the haptic tick.
double density_at_voxel(const DensityGrid& grid, const Vec3& voxel) noexcept;

/// Returns the gradient of the density in W (density per mm). Averages each difference over its 3 x 3
/// neighbours with weights 3, 10, 3 (Scharr), which depends less on the grid's orientation than plain central
/// differences: about a tenth of the error in direction on an edge two voxels wide. Safe in the haptic tick.
Vec3 density_gradient(const DensityGrid& grid, const Vec3& point_W) noexcept;

/// Returns whether a point is in bone: density > isovalue. Safe in the haptic tick.
inline bool is_bone_at(const Volume& volume, const Vec3& point_W) noexcept {
  return density_at(volume.grid(), point_W) > volume.isovalue();
}

/// Returns the number of tool points that are in bone. Safe in the haptic tick.
int count_in_bone(const Volume& volume, std::span<const Vec3> points_T, const Pose& X_WT) noexcept;

/// Returns the outward unit normal of the bone at a point (opposite to the gradient); nullopt if the gradient
/// vanishes. Safe in the haptic tick.
std::optional<Vec3> outward_normal(const Volume& volume, const Vec3& point_W) noexcept;

/// Bisects the segment from a point outside the bone to one inside it down to `tolerance_mm`; returns the end
/// outside the bone. If there are several crossings, finds any one of them. Safe in the haptic tick.
Vec3 bisect_crossing(const Volume& volume, Vec3 outside_W, Vec3 inside_W,
                     double tolerance_mm = 1e-6) noexcept;

/// Returns the first point on the way from `from_W` to `to_W` at which the density rises past the isovalue;
/// nullopt if it does not. Returns `from_W` if that is inside the bone. Samples in steps of at most half a
/// voxel, also for anisotropic voxels, and only within the grid, so that any finite points are safe in the
/// haptic tick.
std::optional<Vec3> first_crossing(const Volume& volume, const Vec3& from_W, const Vec3& to_W) noexcept;

}  // namespace osteomill
