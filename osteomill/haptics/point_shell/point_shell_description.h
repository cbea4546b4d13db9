#pragma once

#include "osteomill/haptics/algorithm_description.h"
#include "osteomill/tool/milling_tool.h"

namespace osteomill::point_shell {

/// What algorithm 3 is made of; point_shell_description.cpp says of each setting what it means, its range and
/// its value in either mode.
struct Settings {
  /// Of the voxels whose centres are points, or of `BoneBricks::kSpacing_mm`.
  int scale = 1;
  /// False (paper): VoxelShell. True: BoneBricks.
  bool surface_shell = false;
  double translational_stiffness_N_per_mm = 0;
  double torsional_stiffness_Nmm_per_rad = 0;
  double damping_time_s = 0;
  double max_depth_mm = 0;
  bool guarded_move = false;
  /// No burr may be pulled through bone by this force: the greatest that a device is sent by default.
  static constexpr double kMaxForce_N = 20;

  static Settings defaults(Mode mode);
};

/// kA in N/mm^3, newton a mm of depth and a mm^2 of surface: the smallest at which `kMaxForce_N` neither
/// pulls the burr through a plane nor presses it deeper than `max_depth_mm` (0: no such rule).
double contact_stiffness_N_per_mm3(const Settings& settings, const MillingTool& tool);

/// Algorithm 3 of the paper (section 6).
AlgorithmDescription description();

}  // namespace osteomill::point_shell
