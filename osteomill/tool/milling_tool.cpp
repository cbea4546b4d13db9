#include "osteomill/tool/milling_tool.h"

#include <algorithm>

#include "osteomill/numbers/positive.h"

namespace osteomill {

void require_valid(const MillingTool& tool) {
  require_positive(tool.burr_radius_mm, "the burr's radius (mm)");
  require_positive(tool.shaft_radius_mm, "the shaft's radius (mm)");
  require_positive(tool.shaft_length_mm, "the shaft's length (mm)");
}

ToolBox bounding_box(const MillingTool& tool) {
  const double wide = std::max(tool.burr_radius_mm, tool.shaft_radius_mm);
  return {{-wide, -wide, -tool.burr_radius_mm},
          {wide, wide, std::max(tool.shaft_length_mm, tool.burr_radius_mm)}};
}

}  // namespace osteomill
