#pragma once

#include "osteomill/haptics/algorithm_description.h"
#include "osteomill/haptics/mode.h"

namespace osteomill::line_proxy {

/// What algorithm 1 is made of; line_proxy_description.cpp says of each setting what it means, its range and
/// its value in either mode.
struct Settings {
  int vertices = 0;
  double stiffness_N_per_mm = 0;
  double friction = 0;
  bool smoothed_normals = false;
  bool hold_line = false;
  double turning_Nmm_per_rad = 0;
  bool show_outside = false;

  /// `paper` as printed, or `steady` with every improvement at the value that was found best.
  static Settings defaults(Mode mode);
};

/// Throws std::invalid_argument, naming the setting, where one is out of range.
void require_valid(const Settings& settings);

/// Algorithm 1 of the paper (section 4).
AlgorithmDescription description();

}  // namespace osteomill::line_proxy
