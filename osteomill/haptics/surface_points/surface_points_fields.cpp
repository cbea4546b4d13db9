#include "osteomill/haptics/surface_points/surface_points_fields.h"

namespace osteomill {

namespace {

using S = SurfacePointsSettings;

constexpr SettingField<S> kFields[] = {
    {"stiffness", [](S& s) -> double& { return s.stiffness_N_per_mm; }, "N/mm"},
    {"slices", [](S& s) -> int& { return s.slices; }},
    {"march-to-surface", [](S& s) -> bool& { return s.march_to_surface; }},
    {"shaft-force", [](S& s) -> bool& { return s.shaft_force; }},
};

}  // namespace

std::span<const SettingField<SurfacePointsSettings>> surface_points_fields() {
  return kFields;
}

}  // namespace osteomill
