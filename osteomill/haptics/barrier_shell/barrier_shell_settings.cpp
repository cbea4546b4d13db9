#include "osteomill/haptics/barrier_shell/barrier_shell_settings.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace osteomill::barrier_shell {

namespace {

void require_positive(double value, const char* name) {
  if (!(std::isfinite(value) && value > 0)) {
    throw std::invalid_argument(std::string("barrier-shell: ") + name + " must be a positive number");
  }
}

}  // namespace

void require_valid(const Settings& settings) {
  require_positive(settings.translational_stiffness_N_per_mm, "the translational stiffness");
  require_positive(settings.torsional_stiffness_Nmm_per_rad, "the torsional stiffness");
  require_positive(settings.skin_width_mm, "the skin's width");
  require_positive(settings.rounding_mm, "the rounding");
  require_positive(settings.pressure_N_per_mm2, "the barrier's pressure");
  require_positive(settings.point_spacing_mm, "the points' spacing");
  require_positive(settings.release_time_s, "the time of release");
  require_positive(settings.release_mm_s, "the release in mm/s");
  require_positive(settings.release_rad_s, "the release in rad/s");
  if (settings.shaft_spacing_factor < 1 || settings.shaft_spacing_factor > 2) {
    throw std::invalid_argument("barrier-shell: the shaft's spacing factor must be 1 or 2");
  }
}

}  // namespace osteomill::barrier_shell
