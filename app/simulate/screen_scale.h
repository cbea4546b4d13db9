#pragma once

#include "osteomill/visual/camera.h"

namespace osteomill::app {

/// A screen as reported by the system.
struct Screen {
  PixelSize size;
  /// 0 if unknown.
  double height_mm = 0;
  /// Text scale set in the system.
  double content_scale = 1;
};

/// Returns the scale at which text and everything sized by it is readable, relative to an ordinary screen (96
/// dpi): the system's, or if that is 1, one chosen by the screen's pixel density.
double scale_for(const Screen& screen);

/// Returns the requested scale, or the largest at which both columns and a view between them fit into the
/// window.
double fitting_scale(double asked, const PixelSize& window);

inline constexpr double kMinScale = 0.7;
inline constexpr double kMaxScale = 4;

}  // namespace osteomill::app
