#pragma once

#include <optional>

#include "osteomill/haptics/mode.h"
#include "osteomill/tool/milling_tool.h"
#include "osteomill/volume/grid_geometry.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::point_shell {

/// What the points of the shell are and how they are kept up.
struct ShellRules {
  int scale = 1;
  bool cells_from_surface_voxels = false;
  bool points_on_isosurface = false;
  bool area_weights = false;
  bool follow_partial_changes = false;
  int refreshed_points_per_tick = 0;
  GradientKernel gradient = GradientKernel::central;
};

/// What algorithm 3 is made of; point_shell_description.cpp says of each setting what it means, its range and
/// its value in either mode.
struct Settings {
  ShellRules shell;
  double translational_stiffness_N_per_mm = 0;
  double torsional_stiffness_Nmm_per_rad = 0;
  double translational_damping_Ns_per_mm = 0;
  double torsional_damping_Nmms_per_rad = 0;
  /// kA: newton a mm of depth and a mm^2 of surface. Left open it follows from the next two.
  std::optional<double> contact_stiffness_N_per_mm3;
  double max_force_N = 0;
  double max_depth_mm = 0;
  bool patch_penalty = false;
  bool closed_form_distance = false;
  /// Spacing of the sampled field; left open, `SampledDistanceField::suitable_spacing_mm`.
  std::optional<double> field_spacing_mm;
  bool brick_kernel = false;
  double max_move_mm = 0;
  double max_turn_rad = 0;
  /// Beside a share of the stretch, so that a long one takes no longer than 0.1 s to fall to a third.
  double max_release_mm_s = 0;
  double max_release_rad_s = 0;
  bool carry_out_of_bone = false;
  bool look_ahead = false;
  int solver_iterations = 0;
  double solver_tolerance_mm = 0;
  double solver_tolerance_rad = 0;

  static Settings defaults(Mode mode);
};

/// Throws std::invalid_argument, naming the setting, where one is out of range.
void require_valid(const Settings& settings);

/// kA in N/mm^3: the one that is set, or the smallest that both rules allow.
double contact_stiffness_N_per_mm3(const Settings& settings, const MillingTool& tool);

}  // namespace osteomill::point_shell
