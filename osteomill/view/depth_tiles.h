#pragma once

#include <vector>

#include "osteomill/view/bone_layer.h"
#include "osteomill/view/frame_target.h"

namespace osteomill {

/// What was drawn so far as the greatest depth in each small square of the picture: what lies behind need not
/// be drawn.
class DepthTiles {
 public:
  /// Reads the depths, which waits for all drawing.
  DepthTiles(const FrameTarget& target, const Projection& projection, const Camera& camera);

  /// Whether all of the sphere lies behind what was drawn.
  bool hide(const Sphere& sphere) const;

 private:
  static constexpr int kTile_px = 16;

  Projection projection_;
  Camera camera_;
  int columns_;
  int rows_;
  // As OpenGL keeps depths, 0 to 1; rows from the top.
  std::vector<float> depths_;
};

}  // namespace osteomill
