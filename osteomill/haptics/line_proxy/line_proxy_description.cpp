#include "osteomill/haptics/line_proxy/line_proxy_description.h"

#include <vector>

#include "osteomill/haptics/line_proxy/line_proxy.h"
#include "osteomill/haptics/setting_fields.h"

namespace osteomill::line_proxy {

namespace {

using Field = SettingField<Settings>;

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
          {"stiffness", "N/mm", SettingRange::positive(), 5, 2, "k of (6) and (10)", "stiffness"},
          [](Settings & s) -> auto& { return s.stiffness_N_per_mm; }),
      setting_field<Settings>(
          {"friction", "", SettingRange::not_negative(), 0, 0,
           "Coefficient of the cone in which the proxies of the tip and of the shaft stay; without effect "
           "with "
           "hold-line"},
          [](Settings & s) -> auto& { return s.friction; }),
      setting_field<Settings>(
          {"smoothed-normals", "", SettingRange::on_or_off(), 0, 1,
           "Normals are the sum of eight smoothed gradients about a point; off: of central differences "
           "there"},
          [](Settings & s) -> auto& { return s.smoothed_normals; }),
      setting_field<Settings>(
          {"hold-line", "", SettingRange::on_or_off(), 0, 1,
           "The whole centreline is held out of the bone, tip, flank and end, and (6) and (11) are what its "
           "springs give; off: a proxy of the tip and a point of the shaft"},
          [](Settings & s) -> auto& { return s.hold_line; }),
      setting_field<Settings>(
          {"shaft-turning-stiffness", "N mm/rad", SettingRange::positive(), 3000, 3000,
           "With hold-line: the spring between the line's direction and the device's; softer below 1 kHz"},
          [](Settings & s) -> auto& { return s.turning_Nmm_per_rad; }),
      setting_field<Settings>(
          {"show-outside", "", SettingRange::on_or_off(), 0, 1,
           "Keeps the drawn tool, as wide as it is, out of bone that its centreline does not touch, and lets "
           "it glide; off: it jumps as its line touches"},
          [](Settings & s) -> auto& { return s.show_outside; }),
  };
  return all;
}

}  // namespace

Settings Settings::defaults(Mode mode) {
  return settings_in<Settings>(mode, fields());
}

void require_valid(const Settings& settings) {
  require_in_range<Settings>(id(), settings, fields());
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
