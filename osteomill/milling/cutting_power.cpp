#include "osteomill/milling/cutting_power.h"

#include <numbers>

#include "osteomill/numbers/positive.h"

namespace osteomill {

double removal_rate_mm3_per_Ns(const CuttingSettings& cutting, double burr_radius_mm) {
  require_positive(cutting.spindle_speed_rpm, "milling: the spindle's speed");
  require_positive(cutting.tangential_share, "milling: the tangential share");
  require_positive(cutting.specific_energy_Nmm_per_mm3, "milling: the specific cutting energy");
  require_positive(burr_radius_mm, "milling: the burr's radius");
  const double rim_speed_mm_s = 2 * std::numbers::pi * burr_radius_mm * cutting.spindle_speed_rpm / 60;
  return rim_speed_mm_s * cutting.tangential_share / cutting.specific_energy_Nmm_per_mm3;
}

}  // namespace osteomill
