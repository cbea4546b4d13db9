#include "barrier_shell/cores.h"

#include <algorithm>
#include <cmath>

namespace osteomill::barrier_shell {

namespace {

// Lower bounds on a length used as a divisor, and on a core's radius and length, mm.
constexpr double kTiny_mm = 1e-9;
constexpr double kMinCore_mm = 0.01;

Mat3 outer(const Vec3& v) {
  return v * v.transpose();
}

}  // namespace

double core_inset_mm(const MillingTool& tool, double rounding_mm) {
  return std::min(rounding_mm,
                  0.5 * std::min({tool.burr_radius_mm, tool.shaft_radius_mm, tool.shaft_length_mm}));
}

Cores Cores::within(const MillingTool& tool, double rounding_mm, double extra_inset_mm) {
  const double inset = core_inset_mm(tool, rounding_mm) + extra_inset_mm;
  return {std::max(tool.burr_radius_mm - inset, kMinCore_mm),
          std::max(tool.shaft_radius_mm - inset, kMinCore_mm),
          std::max(tool.shaft_length_mm - inset, kMinCore_mm)};
}

CoreDistance distance_to_ball(const Cores& cores, const Vec3& point_T) {
  const double from_centre = point_T.norm();
  const Vec3 outward = from_centre > kTiny_mm ? Vec3(point_T / from_centre) : Vec3(-Vec3::UnitZ());
  return {from_centre - cores.ball_radius_mm, outward,
          (Mat3::Identity() - outer(outward)) / std::max(from_centre, kTiny_mm)};
}

CoreDistance distance_to_cylinder(const Cores& cores, const Vec3& point_T) {
  const double rho = std::hypot(point_T.x(), point_T.y());
  const Vec3 radial = rho > kTiny_mm ? Vec3(point_T.x() / rho, point_T.y() / rho, 0) : Vec3::UnitX().eval();
  const Vec3 around(-radial.y(), radial.x(), 0);
  const double beyond_side = rho - cores.cylinder_radius_mm;
  const bool lower_half = point_T.z() < 0.5 * cores.cylinder_length_mm;
  const double beyond_end = lower_half ? -point_T.z() : point_T.z() - cores.cylinder_length_mm;
  const Vec3 end = lower_half ? Vec3(-Vec3::UnitZ()) : Vec3::UnitZ().eval();
  const Mat3 side_curvature = outer(around) / std::max(rho, kTiny_mm);
  if (beyond_end <= 0 && beyond_side >= beyond_end) return {beyond_side, radial, side_curvature};
  if (beyond_side <= 0) return {beyond_end, end, Mat3::Zero()};
  // Nearest to the rim.
  const double distance = std::max(std::hypot(beyond_side, beyond_end), kTiny_mm);
  const double cosine = beyond_side / distance, sine = beyond_end / distance;
  const Vec3 across = cosine * end - sine * radial;
  return {distance, cosine * radial + sine * end, cosine * side_curvature + outer(across) / distance};
}

}  // namespace osteomill::barrier_shell
