#include <algorithm>
#include <cmath>

#include "verification/probing.h"
#include "verification/sections.h"
#include <fmt/core.h>

namespace osteomill::verification {

namespace {

constexpr double kBall_mm = 5;
constexpr double kDepth_mm = 0.5;
constexpr double kSpeed_mm_s = 16;

struct Slide {
  std::vector<double> direction_deg;
  double largest_step_N = 0;
};

// From 50 degrees on one side over the top to 50 on the other, the shaft upright, in the plane at `azimuth`.
void slide(std::string_view algorithm, const Volume& ball, double azimuth, Slide& felt) {
  const MillingTool tool;
  const auto haptics = prepared(algorithm, ball, tool, 1);
  const bool centreline = algorithm == "line-proxy";
  const double radius = kBall_mm + (centreline ? 0 : tool.burr_radius_mm) - kDepth_mm;
  const Vec3 aside(std::cos(azimuth), std::sin(azimuth), 0);
  const auto out_at = [&](double angle) -> Vec3 {
    return std::sin(angle) * aside + std::cos(angle) * Vec3::UnitZ();
  };
  double angle = -0.87;
  Vec3 before = approach(*haptics, (radius + 1.5) * out_at(angle), radius * out_at(angle), Quat::Identity())
                    .wrench.force_N;
  while (angle < 0.87) {
    angle += kSpeed_mm_s * kTick_s / radius;
    const Vec3 out = out_at(angle);
    const Vec3 force = haptics->step({radius * out, Quat::Identity()}, kTick_s).wrench.force_N;
    felt.direction_deg.push_back(kDegrees * std::atan2(out.cross(force).norm(), out.dot(force)));
    felt.largest_step_N = std::max(felt.largest_step_N, (force - before).norm());
    before = force;
  }
}

}  // namespace

Section slide_round_a_ball() {
  Section section{"Sliding round a ball",
                  "Must hold for 1 and 3: the force's direction errs by at most 1 degree (median) and "
                  "2.5 (99 %), and steps by at most 0.005 N from tick to tick; 4: 0.1, 0.5 and 0.002; 2 is "
                  "reported. A burr "
                  "0.5 mm deep in a ball of 5 mm at 16 mm/s, 1 N/mm, over the top in three planes.",
                  {"algorithm, voxels", "direction, degrees: median", "99 %", "largest step, N", ""},
                  {},
                  {}};
  using namespace testing_support;
  for (const double spacing : {0.25, 0.20, 0.10}) {
    const Volume bone =
        shape_volume(centred_cube(static_cast<int>(12 / spacing), spacing), ball(Vec3::Zero(), kBall_mm));
    for (const std::string& algorithm : algorithm_names()) {
      Slide felt;
      for (const double azimuth : {0.0, 0.35, 0.8}) slide(algorithm, bone, azimuth, felt);
      const double median = distribution_of(felt.direction_deg).median;
      const double p99 = percentile(felt.direction_deg, 0.99);
      const bool ours = algorithm == "barrier-shell";
      const bool good = ours ? median <= 0.1 && p99 <= 0.5 && felt.largest_step_N <= 0.002
                             : median <= 1 && p99 <= 2.5 && felt.largest_step_N <= 0.005;
      section.add({fmt::format("{}, {:.2f} mm", algorithm, spacing), figure(median), figure(p99),
                   figure(felt.largest_step_N)},
                  good || algorithm == "surface-points");
    }
  }
  return section;
}

}  // namespace osteomill::verification
