#include "osteomill/milling/cutting_power.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace osteomill {

namespace {

void require_positive(double value, const char* name) {
  if (!(std::isfinite(value) && value > 0)) {
    throw std::invalid_argument(std::string("milling: ") + name + " must be a positive number");
  }
}

}  // namespace

double removal_rate_mm3_per_Ns(const CuttingSettings& cutting, double burr_radius_mm) {
  require_positive(cutting.spindle_speed_rpm, "the spindle's speed");
  require_positive(cutting.tangential_share, "the tangential share");
  require_positive(cutting.specific_energy_Nmm_per_mm3, "the specific cutting energy");
  require_positive(burr_radius_mm, "the burr's radius");
  const double rim_speed_mm_s = 2 * std::numbers::pi * burr_radius_mm * cutting.spindle_speed_rpm / 60;
  return rim_speed_mm_s * cutting.tangential_share / cutting.specific_energy_Nmm_per_mm3;
}

}  // namespace osteomill
