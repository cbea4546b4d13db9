#pragma once

#include "osteomill/base/pose.h"

namespace osteomill {

/// A spherical burr on a cylindrical shaft. In the tool frame T the burr's centre is the origin and the shaft
/// runs along +z, from the burr's centre to z = `shaft_length_mm`, with a flat end.
struct MillingTool {
  double burr_radius_mm = 1.5;
  double shaft_radius_mm = 1.0;
  double shaft_length_mm = 25.0;
  friend bool operator==(const MillingTool&, const MillingTool&) = default;
};

/// Throws std::invalid_argument, naming the dimension, if one is not positive and finite.
void require_valid(const MillingTool& tool);

/// An axis-aligned box in T (bounding_box()).
struct ToolBox {
  Vec3 min_mm;
  Vec3 max_mm;
};
/// Returns the smallest box that contains the tool.
ToolBox bounding_box(const MillingTool& tool);

/// Signed distance of a point to the tool's surface (negative inside) and its gradient, the unit direction
/// out of the tool, both in T. On the axis, where the gradient is undefined, an arbitrary unit vector.
struct ToolDistance {
  double distance_mm;
  Vec3 outward_T;
};

/// Returns the distance in closed form: the smaller of the distances to the burr's sphere and the shaft's
/// cylinder. Exact outside the tool, and inside it except near the junction of the two. Safe in the haptic
/// tick.
ToolDistance tool_distance(const MillingTool& tool, const Vec3& point_T) noexcept;

}  // namespace osteomill
