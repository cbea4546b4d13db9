#include "osteomill/haptics/milling_tool.h"

#include <algorithm>
#include <cmath>

#include "osteomill/base/positive.h"

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

namespace {

ToolDistance sphere_distance(double radius_mm, const Vec3& point) {
  const double length = point.norm();
  return {length - radius_mm, length > 0 ? Vec3(point / length) : Vec3(-Vec3::UnitZ())};
}

ToolDistance cylinder_distance(double radius_mm, double length_mm, const Vec3& point) {
  const double radial = std::hypot(point.x(), point.y());
  const Vec3 outward_radial =
      radial > 0 ? Vec3(point.x() / radial, point.y() / radial, 0) : Vec3(Vec3::UnitX());
  const bool upper = point.z() > 0.5 * length_mm;
  const Vec3 outward_axial = upper ? Vec3::UnitZ().eval() : (-Vec3::UnitZ()).eval();
  const double beyond_side = radial - radius_mm;
  const double beyond_end = upper ? point.z() - length_mm : -point.z();
  if (beyond_side > 0 && beyond_end > 0) {
    const double distance = std::hypot(beyond_side, beyond_end);
    return {distance, (beyond_side * outward_radial + beyond_end * outward_axial) / distance};
  }
  return beyond_side > beyond_end ? ToolDistance{beyond_side, outward_radial}
                                  : ToolDistance{beyond_end, outward_axial};
}

}  // namespace

ToolDistance tool_distance(const MillingTool& tool, const Vec3& point_T) noexcept {
  const ToolDistance burr = sphere_distance(tool.burr_radius_mm, point_T);
  const ToolDistance shaft = cylinder_distance(tool.shaft_radius_mm, tool.shaft_length_mm, point_T);
  return burr.distance_mm < shaft.distance_mm ? burr : shaft;
}

}  // namespace osteomill
