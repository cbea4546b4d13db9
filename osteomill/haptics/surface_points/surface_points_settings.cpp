#include "osteomill/haptics/surface_points/surface_points_settings.h"

#include <cmath>
#include <stdexcept>

namespace osteomill {

SurfacePointsSettings SurfacePointsSettings::defaults(Mode mode) {
  SurfacePointsSettings settings;
  if (mode == Mode::steady) {
    settings.march_to_surface = true;
    settings.shaft_force = true;
  }
  return settings;
}

void require_valid(const SurfacePointsSettings& settings) {
  if (!(std::isfinite(settings.stiffness_N_per_mm) && settings.stiffness_N_per_mm > 0)) {
    throw std::invalid_argument("surface-points: the stiffness must be a positive number of N/mm");
  }
  if (settings.slices < 1 || settings.slices > 1000) {
    throw std::invalid_argument("surface-points: slices must lie between 1 and 1000");
  }
}

}  // namespace osteomill
