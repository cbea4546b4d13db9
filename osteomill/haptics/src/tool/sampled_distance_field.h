#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "osteomill/base/row_major.h"
#include "osteomill/haptics/milling_tool.h"

namespace osteomill {

/// Signed distance to the tool and its gradient, precomputed on a regular grid over the tool's bounding box
/// plus a margin, read by trilinear interpolation (Barbic and James 2008; "SPO" in Eriksson 2012, 6.1).
class SampledDistanceField {
 public:
  /// Fills the grid from `tool_distance`; allocates 16 bytes per node. The grid extends two nodes beyond the
  /// tool's bounding box. Throws std::invalid_argument if an argument is out of range, or the grid would have
  /// more than 16 million nodes.
  SampledDistanceField(const MillingTool& tool, double spacing_mm);

  /// Returns a suitable spacing for the (valid) tool: 1/25 of its smaller radius, or more if that would take
  /// over 2 million nodes.
  static double suitable_spacing_mm(const MillingTool& tool);

  /// Returns the box in T that the field covers.
  const ToolBox& box() const { return box_; }

  /// Returns distance and unit outward direction at a point of T; nothing outside `box()`, which is always
  /// outside the tool. The distance error is at most spacing^2 / (4 * radius) away from the tool's creases.
  /// Safe in the haptic tick.
  std::optional<ToolDistance> at(const Vec3& point_T) const noexcept;

 private:
  // Distance, then gradient.
  using Node = std::array<float, 4>;

  std::size_t node_index(int i, int j, int k) const { return row_major(dims_, i, j, k); }
  void fill(const MillingTool& tool);

  double spacing_mm_;
  std::array<int, 3> dims_{};
  ToolBox box_;
  std::vector<Node> nodes_;
};

}  // namespace osteomill
