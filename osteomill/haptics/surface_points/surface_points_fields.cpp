#include "osteomill/haptics/surface_points/surface_points_fields.h"

namespace osteomill {

namespace {

using S = SurfacePointsSettings;

constexpr SettingField<S> kFields[] = {
    setting_field<S>(
        "stiffness", [](S& s) -> auto& { return s.stiffness_N_per_mm; }, "N/mm"),
    setting_field<S>(
        "slices", [](S& s) -> auto& { return s.slices; }),
    setting_field<S>(
        "march-to-surface", [](S& s) -> auto& { return s.march_to_surface; }),
    setting_field<S>(
        "thin-walls-hold", [](S& s) -> auto& { return s.thin_walls_hold; }),
    setting_field<S>(
        "shaft-force", [](S& s) -> auto& { return s.shaft_force; }),
    setting_field<S>(
        "edge-share", [](S& s) -> auto& { return s.edge_share; }),
    setting_field<S>(
        "slice-levers", [](S& s) -> auto& { return s.slice_levers; }),
    setting_field<S>(
        "hold-tool", [](S& s) -> auto& { return s.hold_tool; }),
    setting_field<S>(
        "rings-per-slice", [](S& s) -> auto& { return s.rings_per_slice; }),
    setting_field<S>(
        "greatest-stiffness", [](S& s) -> auto& { return s.greatest_stiffness_N_per_mm; }, "N/mm"),
    setting_field<S>(
        "bite", [](S& s) -> auto& { return s.bite_voxels; }, "voxels"),
    setting_field<S>(
        "contact-damping", [](S& s) -> auto& { return s.contact_damping_s_per_mm; }, "s/mm"),
};

}  // namespace

std::span<const SettingField<SurfacePointsSettings>> surface_points_fields() {
  return kFields;
}

}  // namespace osteomill
