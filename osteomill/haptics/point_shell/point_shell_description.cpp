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
  // Name, unit, range, value in paper, in steady, meaning, option.
  static const std::vector<Field> all{
      setting_field<Settings>(
          {"scale", "", SettingRange::count(1, 32), 1, 1,
           "Coarseness: a cell of the shell is this many voxels wide along each axis", "shell-scale"},
          [](Settings & s) -> auto& { return s.shell.scale; }),
      setting_field<Settings>(
          {"cells-from-surface-voxels", "", SettingRange::on_or_off(), 0, 1,
           "Above scale 1 a coarse cell stands for the surface voxels in it, at their weighted mean; off: "
           "the density is sampled again on the coarse grid"},
          [](Settings & s) -> auto& { return s.shell.cells_from_surface_voxels; }),
      setting_field<Settings>(
          {"points-on-isosurface", "", SettingRange::on_or_off(), 0, 1,
           "A point lies where the grid's edges to the neighbours that are not bone cross the isosurface; "
           "off: at its voxel's centre, inside the bone"},
          [](Settings & s) -> auto& { return s.shell.points_on_isosurface; }),
      setting_field<Settings>(
          {"area-weights", "", SettingRange::on_or_off(), 0, 1,
           "A point stands for the exposed faces of its voxel seen along the normal; off: for the square of "
           "the cell, whatever the slope"},
          [](Settings & s) -> auto& { return s.shell.area_weights; }),
      setting_field<Settings>(
          {"follow-partial-changes", "", SettingRange::on_or_off(), 0, 1,
           "A point moves also while the densities about it fall; off: only where its voxel begins or ceases "
           "to be a surface voxel"},
          [](Settings & s) -> auto& { return s.shell.follow_partial_changes; }),
      setting_field<Settings>(
          {"refreshed-points-per-tick", "", SettingRange::count(0, 1000000), 0, 256,
           "About how many points a tick brings up to date after milling, brick by brick in turn; 0 all at "
           "once"},
          [](Settings & s) -> auto& { return s.shell.refreshed_points_per_tick; }),
      setting_field<Settings>(
          {"gradient-kernel", "", SettingRange::on_or_off(), 0, 0,
           "The area weights are taken from smoothed gradients; off: from central differences"},
          [](Settings & s) -> auto& { return s.shell.gradient; }),
      setting_field<Settings>(
          {"translational-stiffness", "N/mm", SettingRange::positive(), 2, 2,
           "Virtual coupling between device and simulated tool", "stiffness"},
          [](Settings & s) -> auto& { return s.translational_stiffness_N_per_mm; }),
      setting_field<Settings>(
          {"torsional-stiffness", "N mm/rad", SettingRange::positive(), 1000, 1000, "The same about rotation",
           "torsional-stiffness"},
          [](Settings & s) -> auto& { return s.torsional_stiffness_Nmm_per_rad; }),
      setting_field<Settings>(
          {"translational-damping", "N s/mm", SettingRange::not_negative(), 0, 0,
           "Damping of the coupling, in contact"},
          [](Settings & s) -> auto& { return s.translational_damping_Ns_per_mm; }),
      setting_field<Settings>(
          {"torsional-damping", "N mm s/rad", SettingRange::not_negative(), 0, 0, "The same about rotation"},
          [](Settings & s) -> auto& { return s.torsional_damping_Nmms_per_rad; }),
      setting_field<Settings>(
          {"greatest-force", "N", SettingRange::positive(), 20, 20,
           "The burr must not be pulled through bone by this force: kA >= 1.5 F 27 / (4 pi r^3)"},
          [](Settings & s) -> auto& { return s.max_force_N; }),
      setting_field<Settings>(
          {"greatest-depth", "mm", SettingRange::not_negative(), 0, 0.25,
           "Under that force the burr sinks no deeper into a plane than this; 0 for no such rule"},
          [](Settings & s) -> auto& { return s.max_depth_mm; }),
      setting_field<Settings>(
          {"patch-penalty", "", SettingRange::on_or_off(), 0, 1,
           "A point pushes with the mean depth of the patch of surface it stands for; needs area-weights"},
          [](Settings & s) -> auto& { return s.patch_penalty; }),
      setting_field<Settings>(
          {"closed-form-distance", "", SettingRange::on_or_off(), 0, 1,
           "The tool's distance is computed in closed form; off: read from a sampled field"},
          [](Settings & s) -> auto& { return s.closed_form_distance; }),
      setting_field<Settings>(
          {"brick-kernel", "", SettingRange::on_or_off(), 0, 1,
           "The sums over points are taken many at a time, from bricks; off: an octree, point by point. "
           "Needs closed-form-distance"},
          [](Settings & s) -> auto& { return s.brick_kernel; }),
      setting_field<Settings>(
          {"greatest-move", "mm", SettingRange::not_negative(), 0, 0.5,
           "The most that the simulated tool moves between two looks at the bone; 0 for no limit"},
          [](Settings & s) -> auto& { return s.max_move_mm; }),
      setting_field<Settings>(
          {"greatest-turn", "rad", SettingRange::not_negative(), 0, 0.05,
           "The most that it turns between them; 0 for no limit"},
          [](Settings & s) -> auto& { return s.max_turn_rad; }),
      setting_field<Settings>(
          {"greatest-release", "mm/s", SettingRange::not_negative(), 0, 15,
           "How fast the tool may come nearer to the device, beside the device's own motion, once it was "
           "held back; 0 for no limit"},
          [](Settings & s) -> auto& { return s.max_release_mm_s; }),
      setting_field<Settings>(
          {"greatest-release-turn", "rad/s", SettingRange::not_negative(), 0, 0.05,
           "The same of its turning"},
          [](Settings & s) -> auto& { return s.max_release_rad_s; }),
      setting_field<Settings>(
          {"carry-out-of-bone", "", SettingRange::on_or_off(), 0, 1,
           "While the centreline of a tool that began inside bone is in bone, it follows the device and "
           "nothing is felt; off: it is held there from within"},
          [](Settings & s) -> auto& { return s.carry_out_of_bone; }),
      setting_field<Settings>(
          {"look-ahead", "", SettingRange::on_or_off(), 0, 1,
           "In free space contacts are looked for at the pose that the device has reached; off: at the pose "
           "of the tick before"},
          [](Settings & s) -> auto& { return s.look_ahead; }),
      setting_field<Settings>(
          {"solver-iterations", "", SettingRange::count(1, 1000), 1, 2,
           "Newton steps a tick at most; further ones only where the last moved the tool by more than the "
           "tolerances"},
          [](Settings & s) -> auto& { return s.solver_iterations; }),
      setting_field<Settings>(
          {"solver-tolerance", "mm", SettingRange::not_negative(), 0.005, 0.005, "Such a tolerance"},
          [](Settings & s) -> auto& { return s.solver_tolerance_mm; }),
      setting_field<Settings>(
          {"solver-tolerance-turn", "rad", SettingRange::not_negative(), 0.0005, 0.0005,
           "The same of its turning"},
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
