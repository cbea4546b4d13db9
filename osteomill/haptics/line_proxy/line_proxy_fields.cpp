#include "osteomill/haptics/line_proxy/line_proxy_fields.h"

namespace osteomill {

namespace {

using S = LineProxySettings;

constexpr SettingField<S> kFields[] = {
    setting_field<S>(
        "vertices", [](S& s) -> auto& { return s.vertices; }),
    setting_field<S>(
        "stiffness", [](S& s) -> auto& { return s.stiffness_N_per_mm; }, "N/mm"),
    setting_field<S>(
        "translation-steps", [](S& s) -> auto& { return s.translation_steps; }),
    setting_field<S>(
        "rotation-steps", [](S& s) -> auto& { return s.rotation_steps; }),
    setting_field<S>(
        "normal-kernel", [](S& s) -> auto& { return s.normal.kernel; }),
    setting_field<S>(
        "normal-spread", [](S& s) -> auto& { return s.normal.spread_voxels; }, "voxels"),
    setting_field<S>(
        "clamp-fraction", [](S& s) -> auto& { return s.clamp_fraction; }),
    setting_field<S>(
        "tip-proxy-limit", [](S& s) -> auto& { return s.tip_proxy_limit_mm_per_s; }, "mm/s"),
    setting_field<S>(
        "contact-until-proxy-is-free", [](S& s) -> auto& { return s.contact_until_proxy_is_free; }),
    setting_field<S>(
        "shaft-contact", [](S& s) -> auto& { return s.shaft_contact; }),
    setting_field<S>(
        "shaft-turning-stiffness", [](S& s) -> auto& { return s.shaft_turning_Nmm_per_rad; }, "N mm/rad"),
    setting_field<S>(
        "shaft-fade", [](S& s) -> auto& { return s.shaft_fade_radii; }, "shaft radii"),
    setting_field<S>(
        "contact-turning-share", [](S& s) -> auto& { return s.contact_turning_share; }),
    setting_field<S>(
        "contact-slide-limit", [](S& s) -> auto& { return s.contact_slide_limit_mm_per_s; }, "mm/s"),
    setting_field<S>(
        "shaft-force-slew", [](S& s) -> auto& { return s.shaft_force_slew_N_per_s; }, "N/s"),
    setting_field<S>(
        "show-outside", [](S& s) -> auto& { return s.show_outside; }),
    setting_field<S>(
        "tool-glide", [](S& s) -> auto& { return s.tool_glide_mm_per_s; }, "mm/s"),
    setting_field<S>(
        "tool-glide-turn", [](S& s) -> auto& { return s.tool_glide_rad_per_s; }, "rad/s"),
};

}  // namespace

std::span<const SettingField<LineProxySettings>> line_proxy_fields() {
  return kFields;
}

}  // namespace osteomill
