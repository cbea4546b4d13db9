#include "osteomill/haptics/point_shell/point_shell_fields.h"

namespace osteomill {

namespace {

using S = PointShellSettings;

constexpr SettingField<S> kFields[] = {
    setting_field<S>(
        "scale", [](S& s) -> auto& { return s.shell.scale; }),
    setting_field<S>(
        "cells-from-surface-voxels", [](S& s) -> auto& { return s.shell.cells_from_surface_voxels; }),
    setting_field<S>(
        "points-on-isosurface", [](S& s) -> auto& { return s.shell.points_on_isosurface; }),
    setting_field<S>(
        "area-weights", [](S& s) -> auto& { return s.shell.area_weights; }),
    setting_field<S>(
        "follow-partial-changes", [](S& s) -> auto& { return s.shell.follow_partial_changes; }),
    setting_field<S>(
        "refreshed-points-per-tick", [](S& s) -> auto& { return s.shell.refreshed_points_per_tick; }),
    setting_field<S>(
        "gradient-kernel", [](S& s) -> auto& { return s.shell.gradient; }),
    setting_field<S>(
        "translational-stiffness", [](S& s) -> auto& { return s.translational_stiffness_N_per_mm; }, "N/mm"),
    setting_field<S>(
        "torsional-stiffness", [](S& s) -> auto& { return s.torsional_stiffness_Nmm_per_rad; }, "N mm/rad"),
    setting_field<S>(
        "translational-damping", [](S& s) -> auto& { return s.translational_damping_Ns_per_mm; }, "N s/mm"),
    setting_field<S>(
        "torsional-damping", [](S& s) -> auto& { return s.torsional_damping_Nmms_per_rad; }, "N mm s/rad"),
    setting_field<S>(
        "greatest-force", [](S& s) -> auto& { return s.greatest_force_N; }, "N"),
    setting_field<S>(
        "greatest-depth", [](S& s) -> auto& { return s.greatest_depth_mm; }, "mm"),
    setting_field<S>(
        "patch-penalty", [](S& s) -> auto& { return s.patch_penalty; }),
    setting_field<S>(
        "closed-form-distance", [](S& s) -> auto& { return s.closed_form_distance; }),
    setting_field<S>(
        "brick-kernel", [](S& s) -> auto& { return s.brick_kernel; }),
    setting_field<S>(
        "greatest-move", [](S& s) -> auto& { return s.greatest_move_mm; }, "mm"),
    setting_field<S>(
        "greatest-turn", [](S& s) -> auto& { return s.greatest_turn_rad; }, "rad"),
    setting_field<S>(
        "greatest-release", [](S& s) -> auto& { return s.greatest_release_mm_s; }, "mm/s"),
    setting_field<S>(
        "greatest-release-turn", [](S& s) -> auto& { return s.greatest_release_rad_s; }, "rad/s"),
    setting_field<S>(
        "carry-out-of-bone", [](S& s) -> auto& { return s.carry_out_of_bone; }),
    setting_field<S>(
        "look-ahead", [](S& s) -> auto& { return s.look_ahead; }),
    setting_field<S>(
        "solver-iterations", [](S& s) -> auto& { return s.solver_iterations; }),
    setting_field<S>(
        "solver-tolerance", [](S& s) -> auto& { return s.solver_tolerance_mm; }, "mm"),
    setting_field<S>(
        "solver-tolerance-turn", [](S& s) -> auto& { return s.solver_tolerance_rad; }, "rad"),
};

}  // namespace

std::span<const SettingField<PointShellSettings>> point_shell_fields() {
  return kFields;
}

}  // namespace osteomill
