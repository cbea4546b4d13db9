#pragma once

namespace osteomill::barrier_shell {

/// Settings of the barrier-shell algorithm. There are no switches: it has one mode.
struct Settings {
  /// Virtual coupling between device and simulated tool.
  double translational_stiffness_N_per_mm = 2.0;
  double torsional_stiffness_Nmm_per_rad = 1000.0;
  /// How far from the tool's cores the barrier reaches.
  double skin_width_mm = 0.25;
  /// How far the cores lie within the tool, which rounds its rims; at most half of the tool's least radius is
  /// used. The skin's outer side so lies `skin_width_mm - rounding_mm` outside the tool.
  double rounding_mm = 0.20;
  /// The barrier's pressure: p0 / 3 x^2 (3 - 2 x) / (1 - x)^2 at the share x of the skin's width.
  double pressure_N_per_mm2 = 3.0;
  /// The points that the burr meets lie about so far apart, whatever the scan's voxels.
  double point_spacing_mm = 0.13;
  /// How many times as far apart those lie that the shaft meets: 1 or 2.
  int shaft_spacing_factor = 2;
  /// In which time a stretch of the coupling that nothing holds any more falls to a third, if not sooner by
  /// the next two.
  double release_time_s = 0.1;
  double release_mm_s = 15;
  double release_rad_s = 0.05;
};

/// Throws std::invalid_argument, naming the setting, where one is out of range.
void require_valid(const Settings& settings);

}  // namespace osteomill::barrier_shell
