#include "app/simulate/screen_scale.h"

#include <algorithm>
#include <cmath>

namespace osteomill::app {

namespace {

constexpr double kDotsPerInch = 96;
// Screens below this density are used unscaled; many laptops have 120 to 140 dpi and ordinary text.
constexpr double kDense_dpi = 150;
// Plausible screen heights, mm; values outside are treated as unknown.
constexpr double kPlausible_mm[] = {100, 1500};
constexpr int kManyRows = 2000;
constexpr double kOrdinaryRows = 1080;
constexpr double kStep = 0.25;
// Both columns, the view between them, and the rows that cannot scroll, at scale 1.
constexpr double kMinWidth_px = 760;
constexpr double kMinHeight_px = 430;
constexpr double kFineStep = 0.05;

double stepped(double scale, double step) {
  return step * std::floor(scale / step + 1e-9);
}

}  // namespace

double scale_for(const Screen& screen) {
  double scale = screen.content_scale;
  if (!(scale > 1)) {
    scale = 1;
    const double dpi = 25.4 * screen.size.height / std::max(screen.height_mm, 1.0);
    const bool known = screen.height_mm > kPlausible_mm[0] && screen.height_mm < kPlausible_mm[1];
    if (known && dpi > kDense_dpi) scale = stepped(dpi / kDotsPerInch, kStep);
    if (!known && screen.size.height > kManyRows) scale = stepped(screen.size.height / kOrdinaryRows, kStep);
  }
  return std::clamp(scale, 1.0, kMaxScale);
}

double fitting_scale(double asked, const PixelSize& window) {
  const double room = std::min(window.width / kMinWidth_px, window.height / kMinHeight_px);
  if (asked <= room) return std::clamp(asked, kMinScale, kMaxScale);
  return std::clamp(stepped(room, kFineStep), kMinScale, kMaxScale);
}

}  // namespace osteomill::app
