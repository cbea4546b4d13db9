#include "osteomill/haptics/line_proxy/line_proxy_description.h"

#include <limits>
#include <stdexcept>
#include <vector>

#include "osteomill/haptics/line_proxy/line_proxy.h"
#include "osteomill/haptics/line_proxy/line_proxy_settings.h"
#include "osteomill/haptics/setting_fields.h"

namespace osteomill::line_proxy {

namespace {

using Field = SettingField<Settings>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

const AlgorithmId& id() {
  static const AlgorithmId self{"line-proxy", "1 line-proxy", "#c8102e"};
  return self;
}

const std::vector<Field>& fields() {
  // Name, unit, range, value in paper, in steady, meaning, option.
  static const std::vector<Field> all{
      setting_field<Settings>(
          {"vertices", "", SettingRange::count(2, 100000), 51, 51,
           "Vertices on the tool's centreline, the burr's centre included", "vertices"},
          [](Settings & s) -> auto& { return s.vertices; }),
      setting_field<Settings>(
          {"stiffness", "N/mm", SettingRange::positive(), 2, 2, "k of (6) and (10)", "stiffness"},
          [](Settings & s) -> auto& { return s.stiffness_N_per_mm; }),
      setting_field<Settings>(
          {"translation-steps", "", SettingRange::count(1, 10000), 10, 10, "Translations of the walk, (3)"},
          [](Settings & s) -> auto& { return s.translation_steps; }),
      setting_field<Settings>(
          {"rotation-steps", "", SettingRange::count(1, 10000), 10, 10, "Rotations of the walk, (4)"},
          [](Settings & s) -> auto& { return s.rotation_steps; }),
      setting_field<Settings>(
          {"normal-kernel", "", SettingRange::on_or_off(), 1, 1,
           "Normals are taken from smoothed gradients; off: from central differences"},
          [](Settings & s) -> auto& { return s.normal.kernel; }),
      setting_field<Settings>(
          {"normal-spread", "voxels", SettingRange::not_negative(), 1.25, 1.25,
           "Half the edge of the cube whose eight corners give a normal; 0 takes the point alone"},
          [](Settings & s) -> auto& { return s.normal.spread_voxels; }),
      setting_field<Settings>(
          {"clamp-fraction", "", SettingRange::on_or_off(), 0, 1,
           "Keeps the fraction of (1) between 0 and 1, so that the intersection point lies on the vertex's "
           "path"},
          [](Settings & s) -> auto& { return s.clamp_fraction; }),
      setting_field<Settings>(
          {"tip-proxy-limit", "mm/s", SettingRange::limit(), kInfinity, 30,
           "How fast the tip's proxy may move beyond the device's own movement, so that the force fades "
           "where the proxy comes free"},
          [](Settings & s) -> auto& { return s.tip_proxy_limit_mm_per_s; }),
      setting_field<Settings>(
          {"contact-until-proxy-is-free", "", SettingRange::on_or_off(), 0, 1,
           "The tip stays in contact until its proxy has a free way to it: no falling through thin walls"},
          [](Settings & s) -> auto& { return s.contact_until_proxy_is_free; }),
      setting_field<Settings>(
          {"shaft-contact", "", SettingRange::on_or_off(), 0, 1,
           "The shaft's reaction comes from where and which way the line must be moved to come free, and is "
           "felt as a force too"},
          [](Settings & s) -> auto& { return s.shaft_contact; }),
      setting_field<Settings>(
          {"shaft-turning-stiffness", "N mm/rad", SettingRange::positive(), 3000, 3000,
           "The spring that holds the tool's orientation to the device's where such a contact turns it; "
           "softer below 1 kHz"},
          [](Settings & s) -> auto& { return s.shaft_turning_Nmm_per_rad; }),
      setting_field<Settings>(
          {"shaft-fade", "shaft radii", SettingRange::not_negative(), 0, 4,
           "From the tip to here the shaft's reaction grows from nothing to full"},
          [](Settings & s) -> auto& { return s.shaft_fade_radii; }),
      setting_field<Settings>(
          {"contact-turning-share", "", SettingRange::share(), 1, 0.5,
           "How much of the way to where the shaft's contact points its push turns in a tick; above 0"},
          [](Settings & s) -> auto& { return s.contact_turning_share; }),
      setting_field<Settings>(
          {"contact-slide-limit", "mm/s", SettingRange::limit(), kInfinity, 100,
           "How fast the shaft's contact may slide along it"},
          [](Settings & s) -> auto& { return s.contact_slide_limit_mm_per_s; }),
      setting_field<Settings>(
          {"shaft-force-slew", "N/s", SettingRange::limit(), kInfinity, 40,
           "How fast the shaft's reaction may grow beyond what the device's own movement calls for"},
          [](Settings & s) -> auto& { return s.shaft_force_slew_N_per_s; }),
      setting_field<Settings>(
          {"show-outside", "", SettingRange::on_or_off(), 0, 1,
           "Keeps the simulated tool, as wide as it is, out of bone that its centreline does not touch"},
          [](Settings & s) -> auto& { return s.show_outside; }),
      setting_field<Settings>(
          {"tool-glide", "mm/s", SettingRange::limit(), kInfinity, 100,
           "How fast the simulated tool goes over between touching and free, beyond the device's own "
           "movement"},
          [](Settings & s) -> auto& { return s.tool_glide_mm_per_s; }),
      setting_field<Settings>(
          {"tool-glide-turn", "rad/s", SettingRange::limit(), kInfinity, 20, "The same of its turning"},
          [](Settings & s) -> auto& { return s.tool_glide_rad_per_s; }),
  };
  return all;
}

}  // namespace

Settings Settings::defaults(Mode mode) {
  return settings_in<Settings>(mode, fields());
}

void require_valid(const Settings& settings) {
  require_in_range<Settings>(id(), settings, fields());
  if (!(settings.contact_turning_share > 0)) {
    throw std::invalid_argument("line-proxy: contact-turning-share must be above 0");
  }
}

AlgorithmDescription description() {
  return with_settings<LineProxy, Settings>({.id = id(),
                                             .summary = "The tool as a line of vertices; a proxy of tip and "
                                                        "shaft stays on the surface, springs pull to it",
                                             .resolution_setting = "vertices",
                                             .resolution_name = "vertices",
                                             .settings = {},
                                             .make = {}},
                                            fields());
}

}  // namespace osteomill::line_proxy
