#pragma once

#include "osteomill/haptics/mode.h"
#include "osteomill/tool/milling_tool.h"

namespace osteomill::point_shell {

/// What the points of the shell are and how they are kept up.
struct ShellRules {
  static constexpr int kMaxScale = 32;
  /// A cell is so many voxels wide along each axis; in a surface shell of a fine scan more, as many as are
  /// 0.0625 mm.
  int scale = 1;
  /// False (paper): the centres of the surface voxels, each for the square of its cell; points come and go
  /// with their voxels, all at once. True: points lie on the isosurface, where the grid's edges to the
  /// neighbours that are not bone cross it, stand for their voxel's exposed faces seen along the normal, and
  /// move while densities fall; a coarse cell is the weighted mean of the surface voxels in it.
  bool surface_shell = false;
  /// About how many points of a surface shell a tick brings up to date, brick by brick in turn; 0 for all.
  int refreshed_points_per_tick = 256;
};

/// What algorithm 3 is made of; point_shell_description.cpp says of each setting what it means, its range and
/// its value in either mode.
struct Settings {
  ShellRules shell;
  double translational_stiffness_N_per_mm = 0;
  double torsional_stiffness_Nmm_per_rad = 0;
  double max_depth_mm = 0;
  bool guarded_move = false;
  /// How it is computed, not what, and for tests alone: a surface shell's sums point by point from the
  /// octree, in the place of many at a time from bricks.
  bool by_octree = false;

  /// No burr may be pulled through bone by this force: the greatest that a device is sent by default.
  static constexpr double kMaxForce_N = 20;

  static Settings defaults(Mode mode);
};

/// Throws std::invalid_argument, naming the setting, where one is out of range.
void require_valid(const Settings& settings);

/// kA in N/mm^3, newton a mm of depth and a mm^2 of surface: the smallest at which `kMaxForce_N` neither
/// pulls the burr through a plane nor presses it deeper than `max_depth_mm` (0: no such rule).
double contact_stiffness_N_per_mm3(const Settings& settings, const MillingTool& tool);

}  // namespace osteomill::point_shell
