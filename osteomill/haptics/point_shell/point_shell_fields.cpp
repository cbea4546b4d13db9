#include "osteomill/haptics/point_shell/point_shell_fields.h"

namespace osteomill {

namespace {

using S = PointShellSettings;

constexpr SettingField<S> kFields[] = {
    {"scale", [](S& s) -> int& { return s.shell.scale; }},
    {"cells-from-surface-voxels", [](S& s) -> bool& { return s.shell.cells_from_surface_voxels; }},
    {"points-on-isosurface", [](S& s) -> bool& { return s.shell.points_on_isosurface; }},
    {"area-weights", [](S& s) -> bool& { return s.shell.area_weights; }},
    {"follow-partial-changes", [](S& s) -> bool& { return s.shell.follow_partial_changes; }},
    {"translational-stiffness", [](S& s) -> double& { return s.translational_stiffness_N_per_mm; }, "N/mm"},
    {"torsional-stiffness", [](S& s) -> double& { return s.torsional_stiffness_Nmm_per_rad; }, "N mm/rad"},
    {"translational-damping", [](S& s) -> double& { return s.translational_damping_Ns_per_mm; }, "N s/mm"},
    {"torsional-damping", [](S& s) -> double& { return s.torsional_damping_Nmms_per_rad; }, "N mm s/rad"},
    {"greatest-force", [](S& s) -> double& { return s.greatest_force_N; }, "N"},
    {"greatest-depth", [](S& s) -> double& { return s.greatest_depth_mm; }, "mm"},
    {"closed-form-distance", [](S& s) -> bool& { return s.closed_form_distance; }},
    {"brick-kernel", [](S& s) -> bool& { return s.brick_kernel; }},
    {"greatest-move", [](S& s) -> double& { return s.greatest_move_mm; }, "mm"},
    {"greatest-turn", [](S& s) -> double& { return s.greatest_turn_rad; }, "rad"},
    {"look-ahead", [](S& s) -> bool& { return s.look_ahead; }},
    {"solver-iterations", [](S& s) -> int& { return s.solver_iterations; }},
    {"solver-tolerance", [](S& s) -> double& { return s.solver_tolerance_mm; }, "mm"},
    {"solver-tolerance-turn", [](S& s) -> double& { return s.solver_tolerance_rad; }, "rad"},
};

}  // namespace

std::span<const SettingField<PointShellSettings>> point_shell_fields() {
  return kFields;
}

}  // namespace osteomill
