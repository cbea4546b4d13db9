#include <vector>

#include "osteomill/haptics/setting_fields.h"

#include "published/point_shell/point_shell.h"

namespace osteomill::point_shell {

namespace {

using Fields = std::vector<Field<Settings>>;

// Range in which all numbers stay finite; poor values within it cause a warning.
constexpr NumberRange kStiffness{0.001, 1e4}, kTorsion{1, 1e7}, kDampingTime{0, 0.1};

const Fields& fields() {
  static const Fields all{
      field<Settings>(
          {.name = "scale",
           .range = NumberRange::count(1, VoxelShell::kMaxScale),
           .doc = "Coarseness of the shell: width of its voxels in the scan's voxels along each axis",
           .option = "shell-scale"},
          &Settings::scale),
      field<Settings>(coupling_stiffness(kStiffness), &Settings::translational_stiffness_N_per_mm),
      field<Settings>(coupling_torsion(kTorsion), &Settings::torsional_stiffness_Nmm_per_rad),
      field<Settings>({.name = "damping-time",
                       .unit = "s",
                       .range = kDampingTime,
                       .doc = "Ratio of the virtual coupling's damping to its stiffness"},
                      &Settings::damping_time_s),
  };
  return all;
}

}  // namespace

AlgorithmDescription description() {
  return with_settings<PointShell, Settings>(
      {.id = {"point-shell", "3 point-shell", "#111111"},
       .summary = "The bone is a shell of points, the tool a signed distance field; a virtual coupling "
                  "connects tool and hand",
       .resolution_setting = "scale",
       .resolution_name = "scale"},
      fields());
}

}  // namespace osteomill::point_shell
