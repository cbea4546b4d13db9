#pragma once

#include <optional>
#include <span>

#include "osteomill/volume/density_grid.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Returns the trilinear density at a point of W. Beyond the border voxels it falls to the outside density
/// within one voxel. Safe in the haptic tick.
double density_at(const DensityGrid& grid, const Vec3& point_W) noexcept;

/// Returns the trilinear density at continuous voxel coordinates, as `density_at` does. Safe in the haptic
/// tick.
double density_at_voxel(const DensityGrid& grid, const Vec3& voxel) noexcept;

/// Returns the gradient of the density in W (density per mm). Each difference is averaged over its 3 x 3
/// neighbours with weights 3, 10, 3 (Scharr), which turns less with the grid than plain central differences:
/// about a tenth of the error in direction on an edge two voxels wide. Safe in the haptic tick.
Vec3 density_gradient(const DensityGrid& grid, const Vec3& point_W) noexcept;

/// Returns whether there is bone at a point: density > isovalue. Safe in the haptic tick.
inline bool is_bone_at(const Volume& volume, const Vec3& point_W) noexcept {
  return density_at(volume.grid(), point_W) > volume.isovalue();
}

/// Returns how many of some points of the tool are in bone. Safe in the haptic tick.
int count_in_bone(const Volume& volume, std::span<const Vec3> points_T, const Pose& X_WT) noexcept;

/// Returns the unit vector out of the bone at a point (against the gradient), or nothing if the density is
/// flat there. Safe in the haptic tick.
std::optional<Vec3> outward_normal(const Volume& volume, const Vec3& point_W) noexcept;

/// Halves the segment from a point outside the bone to one inside it down to `tolerance_mm`; returns the end
/// that is not in bone. If there are several crossings, it may find any of them. Safe in the haptic tick.
Vec3 bisect_crossing(const Volume& volume, Vec3 outside_W, Vec3 inside_W,
                     double tolerance_mm = 1e-6) noexcept;

/// Returns the first point, walking from `from_W` to `to_W` in steps of at most half a voxel, whatever a
/// voxel's shape, at which the density rises past the isovalue; nothing if it never does. For a start inside
/// the bone it returns the start. Safe in the haptic tick, for any finite points: only what lies in the grid
/// is walked.
std::optional<Vec3> first_crossing(const Volume& volume, const Vec3& from_W, const Vec3& to_W) noexcept;

}  // namespace osteomill
