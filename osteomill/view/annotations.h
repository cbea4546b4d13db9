#pragma once

#include <array>
#include <string>
#include <vector>

#include "osteomill/view/camera.h"

namespace osteomill {

/// A line or a word drawn over the picture, pixels from the top left.
struct Annotation {
  struct Line {
    Eigen::Vector2d from;
    Eigen::Vector2d to;
  };
  std::vector<Line> lines;
  /// In the middle of it.
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  std::string text;
};

/// A bar of a round length in mm at the focus, in the lower left corner, at most a quarter of the picture
/// long. Says so where what is nearer is drawn noticeably larger.
Annotation scale_bar_annotation(const Camera& camera, const PixelSize& size);

/// The patient's directions (L R A P S I, of W's LPS axes) about a point in the lower right corner, each
/// where its direction points; those that point almost at the viewer, or away, are left out.
std::vector<Annotation> orientation_letters(const Camera& camera, const PixelSize& size);

}  // namespace osteomill
