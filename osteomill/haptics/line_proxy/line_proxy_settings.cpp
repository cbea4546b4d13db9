#include "osteomill/haptics/line_proxy/line_proxy_settings.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace osteomill {

namespace {

void require(bool in_range, const char* what) {
  if (!in_range) throw std::invalid_argument(std::string("line-proxy: ") + what);
}

// A limit may be infinite (no limit) but neither zero nor NaN, which would hold things still for ever.
void require_limit(double limit, const char* what) {
  require(limit > 0.0, what);
}

}  // namespace

LineProxySettings LineProxySettings::defaults(Mode mode) {
  LineProxySettings settings;
  if (mode == Mode::paper) return settings;
  settings.clamp_fraction = true;
  settings.tip_proxy_limit_mm_per_s = 30.0;
  settings.contact_until_proxy_is_free = true;
  settings.shaft_contact = true;
  settings.shaft_fade_radii = 4.0;
  settings.contact_turning_share = 0.5;
  settings.contact_slide_limit_mm_per_s = 100.0;
  settings.shaft_force_slew_N_per_s = 40.0;
  settings.show_outside = true;
  settings.tool_glide_mm_per_s = 100.0;
  settings.tool_glide_rad_per_s = 20.0;
  return settings;
}

void require_valid(const LineProxySettings& s) {
  require(s.vertices >= 2 && s.vertices <= 100000, "vertices must be between 2 and 100000");
  require(std::isfinite(s.stiffness_N_per_mm) && s.stiffness_N_per_mm > 0.0,
          "stiffness must be a positive number of N/mm");
  require(s.translation_steps >= 1 && s.translation_steps <= 10000,
          "translation steps must be between 1 and 10000");
  require(s.rotation_steps >= 1 && s.rotation_steps <= 10000, "rotation steps must be between 1 and 10000");
  require(s.normal.kernel <= GradientKernel::smoothed, "the normal's kernel must be 0 or 1");
  require(std::isfinite(s.normal.spread_voxels) && s.normal.spread_voxels >= 0.0,
          "the normal's spread must be a number of voxels, 0 or more");
  require_limit(s.tip_proxy_limit_mm_per_s, "the tip proxy's limit must be above 0 mm/s");
  require_limit(s.contact_slide_limit_mm_per_s, "the contact's slide limit must be above 0 mm/s");
  require_limit(s.shaft_force_slew_N_per_s, "the shaft force's slew must be above 0 N/s");
  require_limit(s.tool_glide_mm_per_s, "the tool's glide must be above 0 mm/s");
  require_limit(s.tool_glide_rad_per_s, "the tool's glide must be above 0 rad/s");
  require(std::isfinite(s.shaft_turning_Nmm_per_rad) && s.shaft_turning_Nmm_per_rad > 0.0,
          "the shaft's turning stiffness must be a positive number of N mm/rad");
  require(s.contact_turning_share > 0.0 && s.contact_turning_share <= 1.0,
          "the contact's turning share must lie in (0, 1]");
  require(std::isfinite(s.shaft_fade_radii) && s.shaft_fade_radii >= 0.0,
          "the shaft's fade must be a number of radii, 0 or more");
}

}  // namespace osteomill
