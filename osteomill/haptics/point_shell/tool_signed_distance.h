#pragma once

#include <cmath>
#include <optional>

#include "osteomill/tool/sampled_distance_field.h"

namespace osteomill::point_shell {

/// The tool as the shell's points meet it ("SPO", Eriksson 2012, 6.1): a sampled signed distance field. Safe
/// in the haptic tick once made.
class ToolSignedDistance {
 public:
  ToolSignedDistance() = default;
  explicit ToolSignedDistance(const MillingTool& tool)
      : box_(bounding_box(tool)),
        field_(SampledDistanceField(tool, SampledDistanceField::suitable_spacing_mm(tool))) {
    // A burr no wider than the shaft ends at its equator, where the shaft begins.
    const double squared =
        tool.burr_radius_mm * tool.burr_radius_mm - tool.shaft_radius_mm * tool.shaft_radius_mm;
    burr_top_mm_ = squared > 0 ? std::sqrt(squared) : 0.0;
  }

  /// Everything that touches lies in this box of T.
  const ToolBox& box() const { return box_; }
  /// Distance to the tool; nothing where that is known to be positive without a look.
  std::optional<ToolDistance> distance(const Vec3& point_T) const { return field_->at(point_T); }
  /// Whether a contact there is the burr's: below the height at which the shaft comes out of the sphere.
  bool is_burr(const Vec3& point_T) const { return point_T.z() < burr_top_mm_; }

 private:
  ToolBox box_;
  double burr_top_mm_ = 0;
  std::optional<SampledDistanceField> field_;
};

}  // namespace osteomill::point_shell
