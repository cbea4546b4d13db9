#include "osteomill/haptics/point_shell/point_shell_description.h"

#include <algorithm>
#include <numbers>
#include <vector>

#include "osteomill/haptics/point_shell/point_shell_algorithm.h"
#include "osteomill/haptics/setting_fields.h"

namespace osteomill::point_shell {

namespace {

using Field = SettingField<Settings>;

const std::vector<Field>& fields() {
  // Name, unit, range, value in paper, in steady, meaning, option.
  static const std::vector<Field> all{
      setting_field<&Settings::scale>(
          {"scale", "", SettingRange::count(1, VoxelShell::kMaxScale), 3, 1,
           "Coarseness: the voxels whose centres are points are this many of the scan's wide along each "
           "axis; "
           "with surface-shell the points lie this many times 0.13 mm apart, or as the scan's voxels do",
           "shell-scale"}),
      setting_field<&Settings::surface_shell>(
          {"surface-shell", "", SettingRange::on_or_off(), 0, 1,
           "Points lie on the isosurface, each for the patch of surface that it stands for, and follow "
           "densities as they fall; off: voxel centres inside the bone, all alike"}),
      setting_field<&Settings::translational_stiffness_N_per_mm>(
          {"translational-stiffness", "N/mm", SettingRange::positive(), 5, 2,
           "Virtual coupling between device and simulated tool", "stiffness"}),
      setting_field<&Settings::torsional_stiffness_Nmm_per_rad>(
          {"torsional-stiffness", "N mm/rad", SettingRange::positive(), 2500, 1000,
           "Of the coupling, about rotation", "torsional-stiffness"}),
      setting_field<&Settings::damping_time_s>({"damping-time", "s", SettingRange::not_negative(), 0.001, 0,
                                                "The coupling's dampers are its springs times this"}),
      setting_field<&Settings::max_depth_mm>(
          {"greatest-depth", "mm", SettingRange::not_negative(), 0, 0.2,
           "Under 20 N the burr sinks no deeper into a plane than this; 0: it is only not pulled through"}),
      setting_field<&Settings::guarded_move>(
          {"guarded-move", "", SettingRange::on_or_off(), 0, 1,
           "The tool looks where it goes: two Newton steps a tick, 0.5 mm and 0.05 rad at most, and beside "
           "what the device's own move leads it to 15 mm/s and 0.05 rad/s; off: one step of any length"}),
  };
  return all;
}

}  // namespace

Settings Settings::defaults(Mode mode) {
  return settings_in<Settings>(mode, fields());
}

AlgorithmDescription description() {
  return with_settings<PointShellAlgorithm, Settings>(
      {.id = {"point-shell", "3 point-shell", "#111111"},
       .summary =
           "The bone as a shell of points, the tool as a signed distance field, a virtual coupling between",
       .resolution_setting = "scale",
       .resolution_name = "scale"},
      fields());
}

double contact_stiffness_N_per_mm3(const Settings& settings, const MillingTool& tool) {
  const double r = tool.burr_radius_mm;
  constexpr double kPi = std::numbers::pi;
  // On a plane the burr's penalty is kA pi (r - d) d^2, which peaks at d = 2r/3; half as much again is kept
  // back.
  const double no_pull_through = 1.5 * Settings::kMaxForce_N * 27 / (4 * kPi * r * r * r);
  if (!(settings.max_depth_mm > 0)) return no_pull_through;
  const double d = std::min(settings.max_depth_mm, 2 * r / 3);
  return std::max(no_pull_through, Settings::kMaxForce_N / (kPi * (r - d) * d * d));
}

}  // namespace osteomill::point_shell
