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
  settings.intersection_jump_limit_mm = 1.0;
  settings.refuse_behind_tip = true;
  settings.intersection_slide_limit_mm = 0.1;
  settings.tip_proxy_limit_mm = 0.05;
  settings.contact_until_proxy_is_free = true;
  settings.shaft_probe = ShaftProbeRule::deepest_across;
  settings.shaft_pushes = true;
  settings.shaft_fade_radii = 1.5;
  settings.shaft_force_slew_N = 0.5;
  settings.tool_glide_mm = 0.1;
  settings.tool_glide_rad = 0.02;
  return settings;
}

void require_valid(const LineProxySettings& s) {
  require(s.vertices >= 2 && s.vertices <= 100000, "vertices must be between 2 and 100000");
  require(std::isfinite(s.stiffness_N_per_mm) && s.stiffness_N_per_mm > 0.0,
          "stiffness must be a positive number of N/mm");
  require(s.translation_steps >= 1 && s.translation_steps <= 10000,
          "translation steps must be between 1 and 10000");
  require(s.rotation_steps >= 1 && s.rotation_steps <= 10000, "rotation steps must be between 1 and 10000");
  require(s.shaft_probe <= ShaftProbeRule::deepest_across, "the shaft probe must be 0, 1 or 2");
  require(s.normal.kernel <= GradientKernel::smoothed, "the normal's kernel must be 0 or 1");
  require(std::isfinite(s.normal.spread_voxels) && s.normal.spread_voxels >= 0.0,
          "the normal's spread must be a number of voxels, 0 or more");
  require_limit(s.intersection_jump_limit_mm, "the intersection point's jump limit must be above 0 mm");
  require_limit(s.intersection_slide_limit_mm, "the intersection point's slide limit must be above 0 mm");
  require_limit(s.tip_proxy_limit_mm, "the tip proxy's limit must be above 0 mm");
  require_limit(s.shaft_force_slew_N, "the shaft force's slew must be above 0 N");
  require_limit(s.tool_glide_mm, "the tool's glide must be above 0 mm");
  require_limit(s.tool_glide_rad, "the tool's glide must be above 0 rad");
  require(std::isfinite(s.shaft_fade_radii) && s.shaft_fade_radii >= 0.0,
          "the shaft's fade must be a number of radii, 0 or more");
}

}  // namespace osteomill
