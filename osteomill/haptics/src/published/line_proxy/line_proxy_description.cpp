#include <vector>

#include "osteomill/haptics/setting_fields.h"

#include "published/line_proxy/line_proxy.h"

namespace osteomill::line_proxy {

namespace {

using Fields = std::vector<Field<Settings>>;

// Range in which all numbers stay finite; poor values within it cause a warning.
constexpr NumberRange kStiffness{0.001, 1e4};

const Fields& fields() {
  static const Fields all{
      field<Settings>({.name = "vertices",
                       .range = NumberRange::count(2, 100000),
                       .doc = "Number of vertices on the tool's centreline, including the burr's centre",
                       .option = "vertices"},
                      &Settings::vertices),
      field<Settings>(
          {.name = "stiffness",
           .unit = "N/mm",
           .range = kStiffness,
           .doc = "Stiffness of the spring between the proxy and the tool; k in (6) and (10) of the paper",
           .option = "stiffness"},
          &Settings::stiffness_N_per_mm),
  };
  return all;
}

}  // namespace

AlgorithmDescription description() {
  return with_settings<LineProxy, Settings>(
      {.id = {"line-proxy", "1 line-proxy", "#c8102e"},
       .summary = "The tool is a line of vertices; proxies of tip and shaft stay on the surface, and "
                  "springs pull the hand towards them",
       .resolution_setting = "vertices",
       .resolution_name = "vertices"},
      fields());
}

}  // namespace osteomill::line_proxy
