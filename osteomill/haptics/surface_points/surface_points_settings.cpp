#include "osteomill/haptics/surface_points/surface_points_settings.h"

#include <cmath>
#include <stdexcept>

namespace osteomill {

SurfacePointsSettings SurfacePointsSettings::defaults(Mode mode) {
  SurfacePointsSettings settings;
  if (mode == Mode::steady) {
    settings.march_to_surface = true;
    settings.thin_walls_hold = true;
    settings.shaft_force = true;
    settings.edge_share = 0.1;
    settings.slice_levers = true;
    settings.hold_tool = true;
    settings.rings_per_slice = 3;
    settings.greatest_stiffness_N_per_mm = 3.0;
    settings.bite_voxels = 0.3;
    settings.contact_damping_s_per_mm = 0.003;
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
  if (settings.rings_per_slice < 1 || settings.rings_per_slice > 10) {
    throw std::invalid_argument("surface-points: rings per slice must lie between 1 and 10");
  }
  if (!(settings.greatest_stiffness_N_per_mm > 0)) {
    throw std::invalid_argument("surface-points: the greatest stiffness must be a positive number of N/mm");
  }
  if (!(settings.edge_share >= 0 && settings.edge_share <= 1)) {
    throw std::invalid_argument("surface-points: the edge's share must lie between 0 and 1");
  }
  if (!(std::isfinite(settings.bite_voxels) && settings.bite_voxels >= 0)) {
    throw std::invalid_argument("surface-points: the bite must be a number of voxels, 0 or more");
  }
  if (!(std::isfinite(settings.contact_damping_s_per_mm) && settings.contact_damping_s_per_mm >= 0)) {
    throw std::invalid_argument("surface-points: the contact's damping must be a number of s/mm, 0 or more");
  }
}

}  // namespace osteomill
