#pragma once

#include "osteomill/haptics/line_proxy/surface_normal.h"
#include "osteomill/haptics/mode.h"

namespace osteomill::line_proxy {

/// What algorithm 1 is made of; line_proxy_description.cpp says of each setting what it means, its range and
/// its value in either mode. Limits are per second, so that the haptic rate does not matter, and may be
/// infinite.
struct Settings {
  int vertices = 0;
  double stiffness_N_per_mm = 0;
  int translation_steps = 0;
  int rotation_steps = 0;
  NormalRule normal;
  bool clamp_fraction = false;
  double tip_proxy_limit_mm_per_s = 0;
  bool contact_until_proxy_is_free = false;
  bool shaft_contact = false;
  double shaft_turning_Nmm_per_rad = 0;
  double shaft_fade_radii = 0;
  double contact_turning_share = 0;
  double contact_slide_limit_mm_per_s = 0;
  double shaft_force_slew_N_per_s = 0;
  bool show_outside = false;
  double tool_glide_mm_per_s = 0;
  double tool_glide_rad_per_s = 0;

  /// `paper` as printed, or `steady` with every improvement at the value that was found best.
  static Settings defaults(Mode mode);
};

/// Throws std::invalid_argument, naming the setting, where one is out of range.
void require_valid(const Settings& settings);

}  // namespace osteomill::line_proxy
