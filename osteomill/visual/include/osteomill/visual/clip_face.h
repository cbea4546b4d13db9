#pragma once

#include <array>
#include <vector>

#include "osteomill/visual/scene.h"
#include "osteomill/volume/density_grid.h"
#include "osteomill/volume/label_map.h"

namespace osteomill {

/// Image of the face exposed by a cut, RGB, row by row. The corners are the centres of the first pixel, of
/// the end of its row, of the last pixel, and of the start of the last row.
struct ClipFace {
  std::array<Vec3, 4> corners_W;
  int width = 0;
  int height = 0;
  std::vector<std::array<unsigned char, 3>> pixels;
};

/// Densities drawn black and white (window_level_of()).
struct WindowLevel {
  double black = 0;
  double white = 1;
  friend bool operator==(const WindowLevel&, const WindowLevel&) = default;
};

/// Returns a window from just below the surroundings to nearly the densest bone (the densest 0.2 % saturate
/// to white).
WindowLevel window_level_of(const DensityGrid& grid, double surroundings_density);

/// Samples the densities in the plane as grey values, one pixel per voxel but at most `max_pixels` along a
/// side; black outside the grid. With `labels`, each pixel is tinted by the label of its nearest voxel.
/// Returns no pixels if the plane misses the grid. Not real-time safe.
ClipFace clip_face(const DensityGrid& grid, const ClipPlane& plane, const WindowLevel& window,
                   const LabelMap* labels = nullptr, int max_pixels = 320);

/// Returns the corners of a box of voxels; the first voxel is first and the last one last.
std::array<Vec3, 8> corners_W(const GridGeometry& geometry, const VoxelBox& voxels);

/// Returns the minimum and maximum of normal . p over the corners, i.e. the useful range of a plane's offset.
std::array<double, 2> extent_along(const std::array<Vec3, 8>& corners, const Vec3& normal_W);

}  // namespace osteomill
