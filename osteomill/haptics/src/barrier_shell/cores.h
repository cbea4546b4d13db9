#pragma once

#include "osteomill/haptics/milling_tool.h"

namespace osteomill::barrier_shell {

/// Returns how far within the tool's surface its cores lie: the rounding, but at most half of the least of
/// its two radii and the shaft's length.
double inset_within(const MillingTool& tool, double rounding_mm);

/// The two convex bodies within the tool that bone never reaches, in T: a ball about the burr's centre and a
/// cylinder along the shaft from z = 0 to `cylinder_length_mm`. A burr of another convex shape would be
/// another core.
struct Cores {
  double ball_radius_mm;
  double cylinder_radius_mm;
  double cylinder_length_mm;

  /// Returns the cores `inset_within` the tool's surface; `smaller_mm` further within if a tool that began in
  /// touch with bone has not yet grown to its size (at least a hair of each core stays).
  static Cores within(const MillingTool& tool, double rounding_mm, double smaller_mm = 0);
};

/// Distance of a point of bone to a core (negative inside), its gradient (the unit direction out of the core)
/// and its second derivative, all in T and by the point's place.
struct CoreDistance {
  double distance_mm;
  Vec3 outward_T;
  Mat3 curvature_per_mm;
};

/// Return the distance in closed form. Safe in the haptic tick.
CoreDistance distance_to_ball(const Cores& cores, const Vec3& point_T);
CoreDistance distance_to_cylinder(const Cores& cores, const Vec3& point_T);

}  // namespace osteomill::barrier_shell
