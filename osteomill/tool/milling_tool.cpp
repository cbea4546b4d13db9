#include "osteomill/tool/milling_tool.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace osteomill {

namespace {

void require_positive(double size_mm, const char* name) {
  if (!(std::isfinite(size_mm) && size_mm > 0)) {
    throw std::invalid_argument(std::string(name) + " must be a positive number of mm");
  }
}

}  // namespace

void require_valid(const MillingTool& tool) {
  require_positive(tool.burr_radius_mm, "the burr's radius");
  require_positive(tool.shaft_radius_mm, "the shaft's radius");
  require_positive(tool.shaft_length_mm, "the shaft's length");
}

ToolBox bounding_box(const MillingTool& tool) {
  const double wide = std::max(tool.burr_radius_mm, tool.shaft_radius_mm);
  return {{-wide, -wide, -tool.burr_radius_mm},
          {wide, wide, std::max(tool.shaft_length_mm, tool.burr_radius_mm)}};
}

}  // namespace osteomill
