#include "osteomill/haptics/point_shell/point_shell_settings.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace osteomill {

namespace {

constexpr int kCoarsestScale = 32;

void require_positive(double value, const char* name) {
  if (!(std::isfinite(value) && value > 0)) {
    throw std::invalid_argument(std::string("point-shell: ") + name + " must be a positive number");
  }
}

void require_not_negative(double value, const char* name) {
  if (!(std::isfinite(value) && value >= 0)) {
    throw std::invalid_argument(std::string("point-shell: ") + name + " must not be negative");
  }
}

}  // namespace

PointShellSettings PointShellSettings::defaults(Mode mode) {
  PointShellSettings settings;
  if (mode == Mode::paper) return settings;
  settings.shell = {.scale = 1,
                    .cells_from_surface_voxels = true,
                    .points_on_isosurface = true,
                    .area_weights = true,
                    .follow_partial_changes = true,
                    .refreshed_points_per_tick = 256,
                    .gradient = GradientKernel::central};
  settings.greatest_depth_mm = 0.25;
  settings.patch_penalty = true;
  settings.closed_form_distance = true;
  settings.brick_kernel = true;
  settings.greatest_move_mm = 0.5;
  settings.greatest_turn_rad = 0.05;
  settings.greatest_release_mm_s = 15;
  settings.greatest_release_rad_s = 0.05;
  settings.carry_out_of_bone = true;
  settings.look_ahead = true;
  settings.solver_iterations = 2;
  return settings;
}

void require_valid(const PointShellSettings& settings) {
  if (settings.shell.scale < 1 || settings.shell.scale > kCoarsestScale) {
    throw std::invalid_argument("point-shell: the shell's scale must lie between 1 and 32");
  }
  if (settings.shell.refreshed_points_per_tick < 0) {
    throw std::invalid_argument("point-shell: the points refreshed a tick must not be negative");
  }
  if (settings.shell.gradient > GradientKernel::smoothed) {
    throw std::invalid_argument("point-shell: the gradient's kernel must be 0 or 1");
  }
  require_positive(settings.translational_stiffness_N_per_mm, "the translational stiffness");
  require_positive(settings.torsional_stiffness_Nmm_per_rad, "the torsional stiffness");
  require_not_negative(settings.translational_damping_Ns_per_mm, "the translational damping");
  require_not_negative(settings.torsional_damping_Nmms_per_rad, "the torsional damping");
  require_positive(settings.contact_stiffness_N_per_mm3.value_or(1), "the contact stiffness");
  require_positive(settings.greatest_force_N, "the greatest force");
  require_not_negative(settings.greatest_depth_mm, "the greatest depth");
  require_positive(settings.field_spacing_mm.value_or(1), "the distance field's spacing");
  require_not_negative(settings.greatest_move_mm, "the greatest move a tick");
  require_not_negative(settings.greatest_turn_rad, "the greatest turn a tick");
  require_not_negative(settings.greatest_release_mm_s, "the greatest release in mm/s");
  require_not_negative(settings.greatest_release_rad_s, "the greatest release in rad/s");
  require_not_negative(settings.solver_tolerance_mm, "the solver's tolerance in mm");
  require_not_negative(settings.solver_tolerance_rad, "the solver's tolerance in rad");
  if (settings.solver_iterations < 1) {
    throw std::invalid_argument("point-shell: the solver needs at least one iteration");
  }
  if (settings.patch_penalty && !settings.shell.area_weights) {
    throw std::invalid_argument("point-shell: the penalty of patches needs the area weights");
  }
  if (settings.brick_kernel && !settings.closed_form_distance) {
    throw std::invalid_argument("point-shell: the brick kernel needs the closed-form distance");
  }
}

double contact_stiffness_N_per_mm3(const PointShellSettings& settings, const MillingTool& tool) {
  if (settings.contact_stiffness_N_per_mm3) return *settings.contact_stiffness_N_per_mm3;
  const double r = tool.burr_radius_mm;
  constexpr double kPi = std::numbers::pi;
  // On a plane the burr's penalty is kA pi (r - d) d^2, which peaks at d = 2r/3; half as much again is kept
  // back.
  const double no_pull_through = 1.5 * settings.greatest_force_N * 27 / (4 * kPi * r * r * r);
  if (!(settings.greatest_depth_mm > 0)) return no_pull_through;
  const double d = std::min(settings.greatest_depth_mm, 2 * r / 3);
  return std::max(no_pull_through, settings.greatest_force_N / (kPi * (r - d) * d * d));
}

}  // namespace osteomill
