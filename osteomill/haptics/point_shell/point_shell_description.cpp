#include "osteomill/haptics/point_shell/point_shell_description.h"

#include <stdexcept>
#include <string>
#include <vector>

#include "osteomill/haptics/point_shell/point_shell_algorithm.h"
#include "osteomill/haptics/point_shell/point_shell_settings.h"
#include "osteomill/haptics/setting_fields.h"

namespace osteomill::point_shell {

namespace {

using Field = SettingField<Settings>;

const AlgorithmId& id() {
  static const AlgorithmId self{"point-shell", "3 point-shell", "#111111"};
  return self;
}

const std::vector<Field>& fields() {
  static const std::vector<Field> all{
      setting_field<Settings>(
          {.name = "scale",
           .unit = "",
           .range = SettingRange::count(1, 32),
           .paper = 1,
           .steady = 1,
           .meaning = "Coarseness: a cell of the shell is this many voxels wide along each axis",
           .option = "shell-scale"},
          [](Settings & s) -> auto& { return s.shell.scale; }),
      setting_field<Settings>(
          {.name = "cells-from-surface-voxels",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "Above scale 1 a coarse cell stands for the surface voxels in it, at their weighted "
                      "mean; off: the density is sampled again on the coarse grid"},
          [](Settings & s) -> auto& { return s.shell.cells_from_surface_voxels; }),
      setting_field<Settings>(
          {.name = "points-on-isosurface",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "A point lies where the grid's edges to the neighbours that are not bone cross the "
                      "isosurface; off: at its voxel's centre, inside the bone"},
          [](Settings & s) -> auto& { return s.shell.points_on_isosurface; }),
      setting_field<Settings>(
          {.name = "area-weights",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "A point stands for the exposed faces of its voxel seen along the normal; off: for the "
                      "square of the cell, whatever the slope"},
          [](Settings & s) -> auto& { return s.shell.area_weights; }),
      setting_field<Settings>(
          {.name = "follow-partial-changes",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "A point moves also while the densities about it fall; off: only where its voxel "
                      "begins or ceases to be a surface voxel"},
          [](Settings & s) -> auto& { return s.shell.follow_partial_changes; }),
      setting_field<Settings>(
          {.name = "refreshed-points-per-tick",
           .unit = "",
           .range = SettingRange::count(0, 1000000),
           .paper = 0,
           .steady = 256,
           .meaning = "About how many points a tick brings up to date after milling, brick by brick in turn; "
                      "0 all at once"},
          [](Settings & s) -> auto& { return s.shell.refreshed_points_per_tick; }),
      setting_field<Settings>(
          {.name = "gradient-kernel",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 0,
           .meaning = "The area weights are taken from smoothed gradients; off: from central differences"},
          [](Settings & s) -> auto& { return s.shell.gradient; }),
      setting_field<Settings>(
          {.name = "translational-stiffness",
           .unit = "N/mm",
           .range = SettingRange::positive(),
           .paper = 2,
           .steady = 2,
           .meaning = "Virtual coupling between device and simulated tool",
           .option = "stiffness"},
          [](Settings & s) -> auto& { return s.translational_stiffness_N_per_mm; }),
      setting_field<Settings>(
          {.name = "torsional-stiffness",
           .unit = "N mm/rad",
           .range = SettingRange::positive(),
           .paper = 1000,
           .steady = 1000,
           .meaning = "The same about rotation",
           .option = "torsional-stiffness"},
          [](Settings & s) -> auto& { return s.torsional_stiffness_Nmm_per_rad; }),
      setting_field<Settings>(
          {.name = "translational-damping",
           .unit = "N s/mm",
           .range = SettingRange::not_negative(),
           .paper = 0,
           .steady = 0,
           .meaning = "Damping of the coupling, in contact"},
          [](Settings & s) -> auto& { return s.translational_damping_Ns_per_mm; }),
      setting_field<Settings>(
          {.name = "torsional-damping",
           .unit = "N mm s/rad",
           .range = SettingRange::not_negative(),
           .paper = 0,
           .steady = 0,
           .meaning = "The same about rotation"},
          [](Settings & s) -> auto& { return s.torsional_damping_Nmms_per_rad; }),
      setting_field<Settings>(
          {.name = "greatest-force",
           .unit = "N",
           .range = SettingRange::positive(),
           .paper = 20,
           .steady = 20,
           .meaning = "The burr must not be pulled through bone by this force: kA >= 1.5 F 27 / (4 pi r^3)"},
          [](Settings & s) -> auto& { return s.max_force_N; }),
      setting_field<Settings>(
          {.name = "greatest-depth",
           .unit = "mm",
           .range = SettingRange::not_negative(),
           .paper = 0,
           .steady = 0.25,
           .meaning = "Under that force the burr sinks no deeper into a plane than this; 0 for no such rule"},
          [](Settings & s) -> auto& { return s.max_depth_mm; }),
      setting_field<Settings>(
          {.name = "patch-penalty",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "A point pushes with the mean depth of the patch of surface it stands for; needs "
                      "area-weights"},
          [](Settings & s) -> auto& { return s.patch_penalty; }),
      setting_field<Settings>(
          {.name = "closed-form-distance",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "The tool's distance is computed in closed form; off: read from a sampled field"},
          [](Settings & s) -> auto& { return s.closed_form_distance; }),
      setting_field<Settings>(
          {.name = "brick-kernel",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "The sums over points are taken many at a time, from bricks; off: an octree, point by "
                      "point. Needs closed-form-distance"},
          [](Settings & s) -> auto& { return s.brick_kernel; }),
      setting_field<Settings>(
          {.name = "greatest-move",
           .unit = "mm",
           .range = SettingRange::not_negative(),
           .paper = 0,
           .steady = 0.5,
           .meaning = "The most that the simulated tool moves between two looks at the bone; 0 for no limit"},
          [](Settings & s) -> auto& { return s.max_move_mm; }),
      setting_field<Settings>(
          {.name = "greatest-turn",
           .unit = "rad",
           .range = SettingRange::not_negative(),
           .paper = 0,
           .steady = 0.05,
           .meaning = "The most that it turns between them; 0 for no limit"},
          [](Settings & s) -> auto& { return s.max_turn_rad; }),
      setting_field<Settings>(
          {.name = "greatest-release",
           .unit = "mm/s",
           .range = SettingRange::not_negative(),
           .paper = 0,
           .steady = 15,
           .meaning = "How fast the tool may come nearer to the device, beside the device's own motion, once "
                      "it was held back; 0 for no limit"},
          [](Settings & s) -> auto& { return s.max_release_mm_s; }),
      setting_field<Settings>(
          {.name = "greatest-release-turn",
           .unit = "rad/s",
           .range = SettingRange::not_negative(),
           .paper = 0,
           .steady = 0.05,
           .meaning = "The same of its turning"},
          [](Settings & s) -> auto& { return s.max_release_rad_s; }),
      setting_field<Settings>(
          {.name = "carry-out-of-bone",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "While the centreline of a tool that began inside bone is in bone, it follows the "
                      "device and nothing is felt; off: it is held there from within"},
          [](Settings & s) -> auto& { return s.carry_out_of_bone; }),
      setting_field<Settings>(
          {.name = "look-ahead",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "In free space contacts are looked for at the pose that the device has reached; off: "
                      "at the pose of the tick before"},
          [](Settings & s) -> auto& { return s.look_ahead; }),
      setting_field<Settings>(
          {.name = "solver-iterations",
           .unit = "",
           .range = SettingRange::count(1, 1000),
           .paper = 1,
           .steady = 2,
           .meaning = "Newton steps a tick at most; further ones only where the last moved the tool by more "
                      "than the tolerances"},
          [](Settings & s) -> auto& { return s.solver_iterations; }),
      setting_field<Settings>(
          {.name = "solver-tolerance",
           .unit = "mm",
           .range = SettingRange::not_negative(),
           .paper = 0.005,
           .steady = 0.005,
           .meaning = "Such a tolerance"},
          [](Settings & s) -> auto& { return s.solver_tolerance_mm; }),
      setting_field<Settings>(
          {.name = "solver-tolerance-turn",
           .unit = "rad",
           .range = SettingRange::not_negative(),
           .paper = 0.0005,
           .steady = 0.0005,
           .meaning = "The same of its turning"},
          [](Settings & s) -> auto& { return s.solver_tolerance_rad; }),
  };
  return all;
}

}  // namespace

Settings Settings::defaults(Mode mode) {
  return settings_in<Settings>(mode, fields());
}

void require_valid(const Settings& settings) {
  require_in_range<Settings>(id(), settings, fields());
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("point-shell: ") + what);
  };
  require(settings.contact_stiffness_N_per_mm3.value_or(1) > 0, "the contact stiffness must be above 0");
  require(settings.field_spacing_mm.value_or(1) > 0, "the distance field's spacing must be above 0");
  require(!settings.patch_penalty || settings.shell.area_weights, "patch-penalty needs area-weights");
  require(!settings.brick_kernel || settings.closed_form_distance, "brick-kernel needs closed-form-distance");
}

AlgorithmDescription description() {
  return with_settings<PointShellAlgorithm, Settings>(
      {.id = id(),
       .summary =
           "The bone as a shell of points, the tool as a signed distance field, a virtual coupling between",
       .resolution_setting = "scale",
       .resolution_name = "scale",
       .settings = {},
       .make = {}},
      fields());
}

}  // namespace osteomill::point_shell
