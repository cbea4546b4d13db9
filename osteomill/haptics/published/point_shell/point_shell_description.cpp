#include <vector>

#include "osteomill/haptics/published/point_shell/point_shell.h"
#include "osteomill/haptics/setting_fields.h"

namespace osteomill::point_shell {

namespace {

using Field = SettingField<Settings>;

const std::vector<Field>& fields() {
  static const std::vector<Field> all{
      setting_field<&Settings::scale>(
          {"scale", "", SettingRange::count(1, VoxelShell::kMaxScale), 3,
           "Coarseness: the voxels whose centres are points are this many of the scan's wide along each axis",
           "shell-scale"}),
      setting_field<&Settings::translational_stiffness_N_per_mm>(
          {"translational-stiffness", "N/mm", SettingRange::positive(), 5,
           "Virtual coupling between device and simulated tool", "stiffness"}),
      setting_field<&Settings::torsional_stiffness_Nmm_per_rad>(
          {"torsional-stiffness", "N mm/rad", SettingRange::positive(), 2500,
           "Of the coupling, about rotation", "torsional-stiffness"}),
      setting_field<&Settings::damping_time_s>({"damping-time", "s", SettingRange::not_negative(), 0.001,
                                                "The coupling's dampers are its springs times this"}),
  };
  return all;
}

}  // namespace

Settings Settings::defaults() {
  return default_settings<Settings>(fields());
}

AlgorithmDescription description() {
  return with_settings<PointShell, Settings>(
      {.id = {"point-shell", "3 point-shell", "#111111"},
       .summary =
           "The bone as a shell of points, the tool as a signed distance field, a virtual coupling between",
       .resolution_setting = "scale",
       .resolution_name = "scale"},
      fields());
}

}  // namespace osteomill::point_shell
