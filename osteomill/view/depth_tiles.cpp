#include "osteomill/view/depth_tiles.h"

#include <algorithm>

namespace osteomill {

DepthTiles::DepthTiles(const FrameTarget& target, const Projection& projection, const Camera& camera)
    : projection_(projection),
      camera_(camera),
      columns_((projection.size.width + kTile_px - 1) / kTile_px),
      rows_((projection.size.height + kTile_px - 1) / kTile_px),
      depths_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0.0f) {
  const PixelSize& size = projection.size;
  const std::vector<float> drawn = target.read_depths();
  auto depth = drawn.begin();
  for (int y = size.height - 1; y >= 0; --y) {
    for (int x = 0; x < size.width; ++x, ++depth) {
      float& tile = depths_[static_cast<std::size_t>(x / kTile_px + columns_ * (y / kTile_px))];
      tile = std::max(tile, *depth);
    }
  }
}

bool DepthTiles::hide(const Sphere& sphere) const {
  const double front_mm = depth_of(camera_, sphere.centre_W) - sphere.radius_mm;
  if (front_mm <= projection_.near_mm) return false;
  const auto front = static_cast<float>(projection_.far_mm * (front_mm - projection_.near_mm) /
                                        (front_mm * (projection_.far_mm - projection_.near_mm)));
  const Eigen::Vector2d middle = pixel_of(camera_, projection_.size, sphere.centre_W);
  const double reach_px = sphere.radius_mm / mm_per_pixel(camera_, projection_.size, front_mm) + 1;
  const auto tile = [](double pixel, int count) {
    return static_cast<int>(std::clamp(pixel / kTile_px, 0.0, count - 1.0));
  };
  for (int row = tile(middle.y() - reach_px, rows_); row <= tile(middle.y() + reach_px, rows_); ++row) {
    for (int column = tile(middle.x() - reach_px, columns_); column <= tile(middle.x() + reach_px, columns_);
         ++column) {
      if (depths_[static_cast<std::size_t>(column + columns_ * row)] >= front) return false;
    }
  }
  return true;
}

}  // namespace osteomill
