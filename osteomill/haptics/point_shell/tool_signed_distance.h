#pragma once

#include <cmath>
#include <optional>
#include <utility>

#include "osteomill/tool/sampled_distance_field.h"

namespace osteomill::point_shell {

/// The tool as the shell's points meet it ("SPO", Eriksson 2012, 6.1): a sampled signed distance field, or
/// the same distance in closed form. Safe in the haptic tick once made.
class ToolSignedDistance {
 public:
  ToolSignedDistance() = default;
  explicit ToolSignedDistance(const MillingTool& tool)
      : tool_(tool), box_(bounding_box(tool)), burr_top_mm_(burr_top_mm(tool)) {}
  ToolSignedDistance(const MillingTool& tool, SampledDistanceField field) : ToolSignedDistance(tool) {
    field_ = std::move(field);
  }

  const MillingTool& tool() const { return tool_; }
  /// Everything that touches lies in this box of T.
  const ToolBox& box() const { return box_; }
  /// Distance to the tool; nothing where that is known to be positive without a look.
  std::optional<ToolDistance> distance(const Vec3& point_T) const {
    if (field_) return field_->at(point_T);
    return tool_distance(tool_, point_T);
  }
  /// Whether a contact there is the burr's: below the height at which the shaft comes out of the sphere.
  bool is_burr(const Vec3& point_T) const { return point_T.z() < burr_top_mm_; }

  /// The sum of the tool's principal curvatures on the surface near that point (1/mm).
  double curvature_per_mm(const Vec3& point_T) const {
    return is_burr(point_T) ? 2 / tool_.burr_radius_mm : 1 / tool_.shaft_radius_mm;
  }

  /// That height above the burr's centre. A burr no wider than the shaft ends at its equator, where the shaft
  /// begins.
  static double burr_top_mm(const MillingTool& tool) {
    const double squared =
        tool.burr_radius_mm * tool.burr_radius_mm - tool.shaft_radius_mm * tool.shaft_radius_mm;
    return squared > 0 ? std::sqrt(squared) : 0.0;
  }

 private:
  MillingTool tool_;
  ToolBox box_;
  double burr_top_mm_ = 0;
  std::optional<SampledDistanceField> field_;
};

}  // namespace osteomill::point_shell
