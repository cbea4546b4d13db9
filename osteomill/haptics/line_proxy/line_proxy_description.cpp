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
  static const std::vector<Field> all{
      setting_field<Settings>(
          {.name = "vertices",
           .unit = "",
           .range = SettingRange::count(2, 100000),
           .paper = 51,
           .steady = 51,
           .meaning = "Vertices on the tool's centreline, the burr's centre included",
           .option = "vertices"},
          [](Settings & s) -> auto& { return s.vertices; }),
      setting_field<Settings>(
          {.name = "stiffness",
           .unit = "N/mm",
           .range = SettingRange::positive(),
           .paper = 2,
           .steady = 2,
           .meaning = "k of (6) and (10)",
           .option = "stiffness"},
          [](Settings & s) -> auto& { return s.stiffness_N_per_mm; }),
      setting_field<Settings>(
          {.name = "translation-steps",
           .unit = "",
           .range = SettingRange::count(1, 10000),
           .paper = 10,
           .steady = 10,
           .meaning = "Translations of the walk, (3)"},
          [](Settings & s) -> auto& { return s.translation_steps; }),
      setting_field<Settings>(
          {.name = "rotation-steps",
           .unit = "",
           .range = SettingRange::count(1, 10000),
           .paper = 10,
           .steady = 10,
           .meaning = "Rotations of the walk, (4)"},
          [](Settings & s) -> auto& { return s.rotation_steps; }),
      setting_field<Settings>(
          {.name = "normal-kernel",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 1,
           .steady = 1,
           .meaning = "Normals are taken from smoothed gradients; off: from central differences"},
          [](Settings & s) -> auto& { return s.normal.kernel; }),
      setting_field<Settings>(
          {.name = "normal-spread",
           .unit = "voxels",
           .range = SettingRange::not_negative(),
           .paper = 1.25,
           .steady = 1.25,
           .meaning = "Half the edge of the cube whose eight corners give a normal; 0 takes the point alone"},
          [](Settings & s) -> auto& { return s.normal.spread_voxels; }),
      setting_field<Settings>(
          {.name = "clamp-fraction",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "Keeps the fraction of (1) between 0 and 1, so that the intersection point lies on the "
                      "vertex's path"},
          [](Settings & s) -> auto& { return s.clamp_fraction; }),
      setting_field<Settings>(
          {.name = "tip-proxy-limit",
           .unit = "mm/s",
           .range = SettingRange::limit(),
           .paper = kInfinity,
           .steady = 30,
           .meaning = "How fast the tip's proxy may move beyond the device's own movement, so that the force "
                      "fades where the proxy comes free"},
          [](Settings & s) -> auto& { return s.tip_proxy_limit_mm_per_s; }),
      setting_field<Settings>(
          {.name = "contact-until-proxy-is-free",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "The tip stays in contact until its proxy has a free way to it: no falling through "
                      "thin walls"},
          [](Settings & s) -> auto& { return s.contact_until_proxy_is_free; }),
      setting_field<Settings>(
          {.name = "shaft-contact",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "The shaft's reaction comes from where and which way the line must be moved to come "
                      "free, and is felt as a force too"},
          [](Settings & s) -> auto& { return s.shaft_contact; }),
      setting_field<Settings>(
          {.name = "shaft-turning-stiffness",
           .unit = "N mm/rad",
           .range = SettingRange::positive(),
           .paper = 3000,
           .steady = 3000,
           .meaning = "The spring that holds the tool's orientation to the device's where such a contact "
                      "turns it; softer below 1 kHz"},
          [](Settings & s) -> auto& { return s.shaft_turning_Nmm_per_rad; }),
      setting_field<Settings>(
          {.name = "shaft-fade",
           .unit = "shaft radii",
           .range = SettingRange::not_negative(),
           .paper = 0,
           .steady = 4,
           .meaning = "From the tip to here the shaft's reaction grows from nothing to full"},
          [](Settings & s) -> auto& { return s.shaft_fade_radii; }),
      setting_field<Settings>(
          {.name = "contact-turning-share",
           .unit = "",
           .range = SettingRange::share(),
           .paper = 1,
           .steady = 0.5,
           .meaning =
               "How much of the way to where the shaft's contact points its push turns in a tick; above 0"},
          [](Settings & s) -> auto& { return s.contact_turning_share; }),
      setting_field<Settings>(
          {.name = "contact-slide-limit",
           .unit = "mm/s",
           .range = SettingRange::limit(),
           .paper = kInfinity,
           .steady = 100,
           .meaning = "How fast the shaft's contact may slide along it"},
          [](Settings & s) -> auto& { return s.contact_slide_limit_mm_per_s; }),
      setting_field<Settings>(
          {.name = "shaft-force-slew",
           .unit = "N/s",
           .range = SettingRange::limit(),
           .paper = kInfinity,
           .steady = 40,
           .meaning =
               "How fast the shaft's reaction may grow beyond what the device's own movement calls for"},
          [](Settings & s) -> auto& { return s.shaft_force_slew_N_per_s; }),
      setting_field<Settings>(
          {.name = "show-outside",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning =
               "Keeps the simulated tool, as wide as it is, out of bone that its centreline does not touch"},
          [](Settings & s) -> auto& { return s.show_outside; }),
      setting_field<Settings>(
          {.name = "tool-glide",
           .unit = "mm/s",
           .range = SettingRange::limit(),
           .paper = kInfinity,
           .steady = 100,
           .meaning = "How fast the simulated tool goes over between touching and free, beyond the device's "
                      "own movement"},
          [](Settings & s) -> auto& { return s.tool_glide_mm_per_s; }),
      setting_field<Settings>(
          {.name = "tool-glide-turn",
           .unit = "rad/s",
           .range = SettingRange::limit(),
           .paper = kInfinity,
           .steady = 20,
           .meaning = "The same of its turning"},
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
