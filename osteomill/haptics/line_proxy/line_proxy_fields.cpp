#include "osteomill/haptics/line_proxy/line_proxy_fields.h"

namespace osteomill {

namespace {

using S = LineProxySettings;

constexpr SettingField<S> kFields[] = {
    {"vertices", [](S& s) -> int& { return s.vertices; }},
    {"stiffness", [](S& s) -> double& { return s.stiffness_N_per_mm; }, "N/mm"},
    {"translation-steps", [](S& s) -> int& { return s.translation_steps; }},
    {"rotation-steps", [](S& s) -> int& { return s.rotation_steps; }},
    {"normal-spread", [](S& s) -> double& { return s.normal.spread_voxels; }, "voxels"},
    {"clamp-fraction", [](S& s) -> bool& { return s.clamp_fraction; }},
    {"intersection-jump-limit", [](S& s) -> double& { return s.intersection_jump_limit_mm; }, "mm"},
    {"refuse-behind-tip", [](S& s) -> bool& { return s.refuse_behind_tip; }},
    {"intersection-slide-limit", [](S& s) -> double& { return s.intersection_slide_limit_mm; }, "mm"},
    {"tip-proxy-limit", [](S& s) -> double& { return s.tip_proxy_limit_mm; }, "mm"},
    {"contact-until-proxy-is-free", [](S& s) -> bool& { return s.contact_until_proxy_is_free; }},
    {"shaft-pushes", [](S& s) -> bool& { return s.shaft_pushes; }},
    {"shaft-fade", [](S& s) -> double& { return s.shaft_fade_radii; }, "shaft radii"},
    {"shaft-force-slew", [](S& s) -> double& { return s.shaft_force_slew_N; }, "N"},
    {"tool-glide", [](S& s) -> double& { return s.tool_glide_mm; }, "mm"},
    {"tool-glide-turn", [](S& s) -> double& { return s.tool_glide_rad; }, "rad"},
};

}  // namespace

std::span<const SettingField<LineProxySettings>> line_proxy_fields() {
  return kFields;
}

}  // namespace osteomill
