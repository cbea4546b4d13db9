#pragma once

#include <optional>

#include "osteomill/haptics/algorithm_id.h"
#include "osteomill/tool/milling_tool.h"
#include "osteomill/volume/grid_geometry.h"
#include "osteomill/volume/sampling.h"

namespace osteomill {

/// What the points of the shell are and how they are kept up.
struct ShellRules {
  /// Coarseness: a cell of the shell is this many voxels wide along each axis. 1 takes every surface voxel.
  int scale = 1;
  /// Where `scale` > 1. Off (paper): the density is sampled again on the coarse grid, and the shell is that
  /// grid's surface voxels. On: a coarse cell stands for the surface voxels of the scan within it, at their
  /// weighted mean.
  bool cells_from_surface_voxels = false;
  /// Off (paper): a point is its voxel's centre, which lies inside the bone. On: it lies on the isosurface,
  /// where the grid's edges to the neighbours that are not bone cross it.
  bool points_on_isosurface = false;
  /// Off (paper): every point stands for h^2 of surface, h the cell's size. On: for the piece of surface that
  /// its voxel's exposed faces cover seen along the surface's normal, so that stiffness does not depend on
  /// the slope.
  bool area_weights = false;
  /// Off (paper): a point changes only where its voxel stops or starts to be a surface voxel. On: also while
  /// the densities about it fall.
  bool follow_partial_changes = false;
  /// 0 (paper): all points near a change are brought up to date at once. Otherwise only about so many a tick,
  /// brick by brick in turn, so that a tick's time stays bounded; the rest wait a few ticks, in which
  /// densities fall little.
  int refreshed_points_per_tick = 0;
  /// The gradient that gives `area_weights` its normal.
  GradientKernel gradient = GradientKernel::central;
};

/// Settings of the point-shell algorithm. Each switch stands on its own; `defaults` gives the two named sets.
struct PointShellSettings {
  ShellRules shell;

  /// Virtual coupling between device and simulated tool.
  double translational_stiffness_N_per_mm = 2.0;
  double torsional_stiffness_Nmm_per_rad = 1000.0;
  /// Damping of the virtual coupling, added to the wrench while in contact; 0 is none.
  double translational_damping_Ns_per_mm = 0.0;
  double torsional_damping_Nmms_per_rad = 0.0;

  /// kA: newton a mm of depth and a mm^2 of surface. Left open it follows from the next two.
  std::optional<double> contact_stiffness_N_per_mm3;
  /// The burr must not be pulled through bone by this force: kA >= 1.5 F 27 / (4 pi r^3).
  double greatest_force_N = 20.0;
  /// Under that force the burr sinks no deeper into a plane than this (0: no such rule).
  double greatest_depth_mm = 0.0;

  /// Off (paper): a point pushes with its own depth. On: with the mean depth of the patch of surface it
  /// stands for, which smooths the start of each point's push; needs `ShellRules::area_weights`, which find
  /// the patch's normal.
  bool patch_penalty = false;

  /// Off (paper): the tool is a sampled signed distance field. On: its distance is computed in closed form.
  bool closed_form_distance = false;
  /// Spacing of the sampled field; left open, `SampledDistanceField::suitable_spacing_mm`.
  std::optional<double> field_spacing_mm;
  /// Off (paper): octree boxes against the tool's box, point by point. On: the same sums from bricks of
  /// points, many points at a time; needs `closed_form_distance`.
  bool brick_kernel = false;

  /// The most that the simulated tool moves and turns between two looks at the bone, whatever the time
  /// between them, so that it passes over nothing; 0 is no limit (paper).
  double greatest_move_mm = 0.0;
  double greatest_turn_rad = 0.0;
  /// How fast the tool may come nearer to the device, beside the device's own motion, once it has been held
  /// back (and beside a share of the stretch, so that a long one takes no longer than 0.1 s to fall to a
  /// third): where bone gives way at once, the coupling's wrench fades and does not step. 0 is no limit
  /// (paper).
  double greatest_release_mm_s = 0.0;
  double greatest_release_rad_s = 0.0;
  /// Off (paper): a tool that begins inside bone meets the surface from within and is held there. On: while
  /// its centreline is in bone it follows the device, nothing is felt, and so it is carried out.
  bool carry_out_of_bone = false;
  /// Off (paper): contacts are looked for at the pose of the tick before. On: in free space already at the
  /// pose that the device has reached, one tick earlier.
  bool look_ahead = false;
  /// Newton steps a tick, at most: 1 is the paper's single solve. Further ones are taken only where the last
  /// one moved the tool by more than the tolerances.
  int solver_iterations = 1;
  double solver_tolerance_mm = 0.005;
  double solver_tolerance_rad = 0.0005;

  static PointShellSettings defaults(Mode mode);
};

/// Throws std::invalid_argument, naming the setting, where one is out of range.
void require_valid(const PointShellSettings& settings);

/// kA in N/mm^3: the one that is set, or the least that both rules allow.
double contact_stiffness_N_per_mm3(const PointShellSettings& settings, const MillingTool& tool);

}  // namespace osteomill
