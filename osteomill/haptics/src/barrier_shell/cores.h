#pragma once

#include "osteomill/haptics/milling_tool.h"

namespace osteomill::barrier_shell {

/// Returns the inset of the cores from the tool's surface, mm: the rounding, but at most half of the smallest
/// of burr radius, shaft radius and shaft length.
double core_inset_mm(const MillingTool& tool, double rounding_mm);

/// The two convex bodies inside the tool that bone never reaches, in T: a ball about the burr's centre and a
/// cylinder along the shaft from z = 0 to `cylinder_length_mm`. A burr of another convex shape would need
/// another core.
struct Cores {
  double ball_radius_mm;
  double cylinder_radius_mm;
  double cylinder_length_mm;

  /// Returns the cores, inset by `core_inset_mm`, and by `extra_inset_mm` more while a tool that started in
  /// contact with bone has not grown to full size (a minimal core always remains).
  static Cores within(const MillingTool& tool, double rounding_mm, double extra_inset_mm = 0);
};

/// Signed distance of a bone point to a core (negative inside), its gradient (the unit direction out of the
/// core) and second derivative with respect to the point's position, all in T.
struct CoreDistance {
  double distance_mm;
  Vec3 outward_T;
  Mat3 curvature_per_mm;
};

/// Return the distance in closed form. Safe in the haptic tick.
CoreDistance distance_to_ball(const Cores& cores, const Vec3& point_T);
CoreDistance distance_to_cylinder(const Cores& cores, const Vec3& point_T);

}  // namespace osteomill::barrier_shell
