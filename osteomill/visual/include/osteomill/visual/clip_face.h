#pragma once

#include <array>
#include <vector>

#include "osteomill/visual/scene.h"
#include "osteomill/volume/density_grid.h"
#include "osteomill/volume/label_map.h"

namespace osteomill {

/// The picture of a face that a cut lays open: red, green and blue, row by row; the corners are the middles
/// of the first pixel, of the end of its row, of the last pixel and of the beginning of the last row.
struct ClipFace {
  std::array<Vec3, 4> corners_W;
  int width = 0;
  int height = 0;
  std::vector<std::array<unsigned char, 3>> pixels;
};

/// The densities that a ClipFace draws black and white (window_level_of()).
struct WindowLevel {
  double black = 0;
  double white = 1;
  friend bool operator==(const WindowLevel&, const WindowLevel&) = default;
};

/// Returns a range from just below the surroundings to nearly the densest bone (the 0.2 % above are white
/// too).
WindowLevel window_level_of(const DensityGrid& grid, double surroundings_density);

/// Returns the densities where the plane meets the grid, a pixel a voxel but no more than `max_pixels` along
/// a side, as grey values; black outside the grid. With `labels`, tinted by those of the voxels nearest to
/// the pixels. There are no pixels if the plane misses the grid. Not for the tick.
ClipFace clip_face(const DensityGrid& grid, const ClipPlane& plane, const WindowLevel& window,
                   const LabelMap* labels = nullptr, int max_pixels = 320);

/// Returns the corners of a box of voxels, with the first voxel first and the last one last.
std::array<Vec3, 8> corners_W(const GridGeometry& geometry, const VoxelBox& voxels);

/// Returns the least and the greatest normal . p over such corners: how far a plane can be moved.
std::array<double, 2> extent_along(const std::array<Vec3, 8>& corners, const Vec3& normal_W);

}  // namespace osteomill
