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
        "shaft-force", [](S& s) -> auto& { return s.shaft_force; }),
};

}  // namespace

std::span<const SettingField<SurfacePointsSettings>> surface_points_fields() {
  return kFields;
}

}  // namespace osteomill
