#pragma once

#include <optional>

#include "osteomill/haptics/bone_points/brick_points.h"
#include "osteomill/haptics/bone_points/penalty.h"
#include "osteomill/haptics/bone_points/tool_from_grid.h"
#include "osteomill/haptics/point_shell/contact_sum.h"
#include "osteomill/haptics/point_shell/tool_signed_distance.h"

namespace osteomill::point_shell {

/// Adds what one point of the shell, at `point_T` in the tool's frame, pushes: Eriksson 2012, 6.3. Safe in
/// the haptic tick.
inline void touch_point(const ShellPoint& point, const Vec3& point_T, const ToolFromGrid& X_TG,
                        const ToolSignedDistance& tool, const Penalty& penalty, ToolContacts& contacts) {
  const std::optional<ToolDistance> distance = tool.distance(point_T);
  if (!distance) return;
  const double cosine = distance->outward_T.dot(X_TG.turn * point.normal());
  const Penalty::Push push = penalty.push(-distance->distance_mm, static_cast<double>(point.area_mm2), cosine,
                                          tool.curvature_per_mm(point_T));
  if (!(push.force_N > 0)) return;
  ContactSum& part = tool.is_burr(point_T) ? contacts.burr : contacts.shaft;
  part.add(push.force_N, push.stiffness_N_per_mm, distance->outward_T, point_T);
  ++contacts.touching;
}

}  // namespace osteomill::point_shell
