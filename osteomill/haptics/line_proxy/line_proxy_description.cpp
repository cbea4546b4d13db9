#include <vector>

#include "osteomill/haptics/line_proxy/line_proxy.h"
#include "osteomill/haptics/setting_fields.h"

namespace osteomill::line_proxy {

namespace {

using Field = SettingField<Settings>;

const std::vector<Field>& fields() {
  // Name, unit, range, value in paper, in steady, meaning, option.
  static const std::vector<Field> all{
      setting_field<&Settings::vertices>({"vertices", "", SettingRange::count(2, 100000), 51, 51,
                                          "Vertices on the tool's centreline, the burr's centre included",
                                          "vertices"}),
      setting_field<&Settings::stiffness_N_per_mm>(
          {"stiffness", "N/mm", SettingRange::positive(), 5, 2, "k of (6) and (10)", "stiffness"}),
      setting_field<&Settings::friction>(
          {"friction", "", SettingRange::not_negative(), 0, 0,
           "Coefficient of the cone in which the proxies of the tip and of the shaft stay; without effect "
           "with "
           "hold-line"}),
      setting_field<&Settings::smoothed_normals>(
          {"smoothed-normals", "", SettingRange::on_or_off(), 0, 1,
           "Normals are the sum of eight smoothed gradients about a point; off: of central differences "
           "there"}),
      setting_field<&Settings::hold_line>(
          {"hold-line", "", SettingRange::on_or_off(), 0, 1,
           "The whole centreline is held out of the bone, tip, flank and end, and (6) and (11) are what its "
           "springs give; off: a proxy of the tip and a point of the shaft"}),
      setting_field<&Settings::turning_Nmm_per_rad>(
          {"shaft-turning-stiffness", "N mm/rad", SettingRange::positive(), 3000, 3000,
           "With hold-line: the spring between the line's direction and the device's; softer below 1 kHz"}),
      setting_field<&Settings::show_outside>(
          {"show-outside", "", SettingRange::on_or_off(), 0, 1,
           "Keeps the drawn tool, as wide as it is, out of bone that its centreline does not touch, and lets "
           "it glide; off: it jumps as its line touches"}),
  };
  return all;
}

}  // namespace

Settings Settings::defaults(Mode mode) {
  return settings_in<Settings>(mode, fields());
}

AlgorithmDescription description() {
  return with_settings<LineProxy, Settings>({.id = {"line-proxy", "1 line-proxy", "#c8102e"},
                                             .summary = "The tool as a line of vertices; a proxy of tip and "
                                                        "shaft stays on the surface, springs pull to it",
                                             .resolution_setting = "vertices",
                                             .resolution_name = "vertices"},
                                            fields());
}

}  // namespace osteomill::line_proxy
