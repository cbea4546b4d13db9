#include <vector>

#include "osteomill/haptics/published/line_proxy/line_proxy.h"
#include "osteomill/haptics/setting_fields.h"

namespace osteomill::line_proxy {

namespace {

using Field = SettingField<Settings>;

const std::vector<Field>& fields() {
  static const std::vector<Field> all{
      setting_field<&Settings::vertices>({"vertices", "", SettingRange::count(2, 100000), 51,
                                          "Vertices on the tool's centreline, the burr's centre included",
                                          "vertices"}),
      setting_field<&Settings::stiffness_N_per_mm>(
          {"stiffness", "N/mm", SettingRange::positive(), 5, "k of (6) and (10)", "stiffness"}),
  };
  return all;
}

}  // namespace

Settings Settings::defaults() {
  return default_settings<Settings>(fields());
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
