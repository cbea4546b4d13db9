#include "osteomill/haptics/point_shell/point_shell_settings.h"

#include <algorithm>
#include <numbers>

namespace osteomill::point_shell {

double contact_stiffness_N_per_mm3(const Settings& settings, const MillingTool& tool) {
  const double r = tool.burr_radius_mm;
  constexpr double kPi = std::numbers::pi;
  // On a plane the burr's penalty is kA pi (r - d) d^2, which peaks at d = 2r/3; half as much again is kept
  // back.
  const double no_pull_through = 1.5 * Settings::kMaxForce_N * 27 / (4 * kPi * r * r * r);
  if (!(settings.max_depth_mm > 0)) return no_pull_through;
  const double d = std::min(settings.max_depth_mm, 2 * r / 3);
  return std::max(no_pull_through, Settings::kMaxForce_N / (kPi * (r - d) * d * d));
}

}  // namespace osteomill::point_shell
