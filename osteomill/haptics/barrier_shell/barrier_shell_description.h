#pragma once

#include "osteomill/haptics/algorithm_description.h"

namespace osteomill::barrier_shell {

/// Settings of the barrier-shell algorithm, as its description says them. There are no switches.
struct Settings {
  double translational_stiffness_N_per_mm = 0;
  double torsional_stiffness_Nmm_per_rad = 0;
  double skin_width_mm = 0;
  double rounding_mm = 0;
  double pressure_N_per_mm2 = 0;
  double point_spacing_mm = 0;
  double release_time_s = 0;
  double release_mm_s = 0;
  double release_rad_s = 0;

  static Settings defaults();
};

/// Throws std::invalid_argument, naming the setting, where one is out of range.
void require_valid(const Settings& settings);

/// Algorithm 4, not the paper's; it has one mode.
AlgorithmDescription description();

}  // namespace osteomill::barrier_shell
