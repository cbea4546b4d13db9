#include "osteomill/visual/clip_face.h"

#include <algorithm>
#include <cmath>

#include "osteomill/volume/sampling.h"

namespace osteomill {

namespace {

// Returns the points at which edges of the grid's bounding box intersect the plane.
std::vector<Vec3> crossings(const GridGeometry& geometry, const ClipPlane& plane) {
  const std::array<Vec3, 8> corners = corners_W(geometry, geometry.all_voxels());
  std::vector<Vec3> found;
  for (std::size_t a = 0; a < 8; ++a) {
    for (const std::size_t bit : {1u, 2u, 4u}) {
      if ((a & bit) != 0) continue;
      const Vec3& from = corners[a];
      const Vec3& to = corners[a | bit];
      const double below = plane.normal_W.dot(from) - plane.offset_mm;
      const double above = plane.normal_W.dot(to) - plane.offset_mm;
      if (below * above > 0 || below == above) continue;
      found.push_back(from + below / (below - above) * (to - from));
    }
  }
  return found;
}

// Blends a label's colour with the grey value, never quite black: a nerve canal may be as dark as air.
std::array<unsigned char, 3> tinted(unsigned char grey, const std::array<std::uint8_t, 3>& label) {
  constexpr double kLabel = 0.55, kMinBlackShare = 0.35;
  const double light = kMinBlackShare + (1 - kMinBlackShare) * grey / 255;
  std::array<unsigned char, 3> pixel{};
  for (std::size_t c = 0; c < 3; ++c)
    pixel[c] = static_cast<unsigned char>((1 - kLabel) * grey + kLabel * light * label[c]);
  return pixel;
}

}  // namespace

WindowLevel window_level_of(const DensityGrid& grid, double surroundings_density) {
  std::vector<float> sample = every_nth_density(grid, 37);
  const auto high =
      sample.begin() + static_cast<std::ptrdiff_t>(0.998 * static_cast<double>(sample.size() - 1));
  std::nth_element(sample.begin(), high, sample.end());
  const double white = std::max(static_cast<double>(*high), surroundings_density + 1);
  return {surroundings_density - 0.02 * (white - surroundings_density), white};
}

std::array<Vec3, 8> corners_W(const GridGeometry& geometry, const VoxelBox& voxels) {
  std::array<Vec3, 8> corners;
  for (std::size_t n = 0; n < 8; ++n) {
    corners[n] = geometry.world_from_voxel(VoxelIndex{(n & 1) != 0 ? voxels.last.i : voxels.first.i,
                                                      (n & 2) != 0 ? voxels.last.j : voxels.first.j,
                                                      (n & 4) != 0 ? voxels.last.k : voxels.first.k});
  }
  return corners;
}

std::array<double, 2> extent_along(const std::array<Vec3, 8>& corners, const Vec3& normal_W) {
  std::array<double, 2> extent{1e300, -1e300};
  for (const Vec3& corner : corners) {
    extent[0] = std::min(extent[0], normal_W.dot(corner));
    extent[1] = std::max(extent[1], normal_W.dot(corner));
  }
  return extent;
}

ClipFace clip_face(const DensityGrid& grid, const ClipPlane& plane, const WindowLevel& window,
                   const LabelMap* labels, int max_pixels) {
  const std::vector<Vec3> border = crossings(grid.geometry(), plane);
  if (border.size() < 3) return {};
  // Any two orthogonal directions in the plane.
  const Vec3 some = std::abs(plane.normal_W.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitY();
  const Vec3 across = some.cross(plane.normal_W).normalized();
  const Vec3 along = plane.normal_W.cross(across);
  Eigen::AlignedBox2d box_mm;
  for (const Vec3& point : border) box_mm.extend(Eigen::Vector2d(across.dot(point), along.dot(point)));
  const Eigen::Vector2d size_mm = box_mm.sizes();
  const double pixel_mm =
      std::max(grid.geometry().spacing_mm.minCoeff(), size_mm.maxCoeff() / (max_pixels - 1));
  ClipFace face;
  face.width = std::max(2, static_cast<int>(size_mm.x() / pixel_mm) + 1);
  face.height = std::max(2, static_cast<int>(size_mm.y() / pixel_mm) + 1);
  const Vec3 first = plane.offset_mm * plane.normal_W + box_mm.min().x() * across + box_mm.min().y() * along;
  const auto at = [&](int x, int y) -> Vec3 { return first + pixel_mm * (x * across + y * along); };
  face.corners_W = {at(0, 0), at(face.width - 1, 0), at(face.width - 1, face.height - 1),
                    at(0, face.height - 1)};
  face.pixels.reserve(static_cast<std::size_t>(face.width) * static_cast<std::size_t>(face.height));
  const double scale = 255 / (window.white - window.black);
  for (int y = 0; y < face.height; ++y) {
    for (int x = 0; x < face.width; ++x) {
      const double bright = scale * (density_at(grid, at(x, y)) - window.black);
      const auto grey = static_cast<unsigned char>(std::clamp(bright, 0.0, 255.0));
      face.pixels.push_back({grey, grey, grey});
      const LabelMap::LabelIndex label = labels == nullptr ? 0 : labels->nearest_to(at(x, y));
      if (label != 0) face.pixels.back() = tinted(grey, labels->label(label).colour);
    }
  }
  return face;
}

}  // namespace osteomill
