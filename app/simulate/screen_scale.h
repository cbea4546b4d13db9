#pragma once

#include "osteomill/visual/camera.h"

namespace osteomill::app {

/// A screen as the system tells of it.
struct Screen {
  PixelSize size;
  /// 0 if it is not known.
  double height_mm = 0;
  /// The factor by which the system wants text larger than usual.
  double content_scale = 1;
};

/// Returns how much larger than on an ordinary screen (96 dots an inch) text and all that is measured by it
/// must be to be read: the factor that the system wants, or, if it wants none, the one that the density of
/// the screen's dots asks for.
double scale_for(const Screen& screen);

/// The scale asked for, or the greatest at which both columns and a view between them have room in the
/// window.
double fitting_scale(double asked, const PixelSize& window);

inline constexpr double kMinScale = 0.7;
inline constexpr double kMaxScale = 4;

}  // namespace osteomill::app
