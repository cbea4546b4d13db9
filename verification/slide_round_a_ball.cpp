#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "verification/probing.h"
#include "verification/sections.h"

namespace osteomill::verification {

namespace {

constexpr double kDepth_mm = 0.5;
constexpr double kSpeed_mm_s = 16;

struct Case {
  double voxel_mm;
  double ball_mm;
  double edge_voxels;
};
constexpr Case kCases[] = {{0.25, 5, 2}, {0.20, 5, 2}, {0.10, 5, 2}, {0.25, 5, 1}, {1, 9, 2}};

struct Slide {
  std::vector<double> direction_deg;
  double largest_step_N = 0;
};

// Slides from 50 degrees on one side over the top to 50 on the other, the shaft upright, in the plane at
// `azimuth`.
void slide(std::string_view algorithm, const Volume& ball, double ball_mm, double azimuth, Slide& felt) {
  const MillingTool tool;
  const auto haptics = prepared(algorithm, ball, tool, 1);
  const bool centreline = algorithm == "line-proxy";
  const double radius = ball_mm + (centreline ? 0 : tool.burr_radius_mm) - kDepth_mm;
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
  Section section{
      "Sliding round a ball",
      "Must hold for 4: the error of the force's direction is at most 0.1 degree (median) and 0.5 "
      "(99 %), and the force steps by at most 0.002 N from tick to tick; in 1 mm voxels, and with "
      "an edge of one voxel, the limits of the error are 0.5 and 1.5. A burr 0.5 mm deep in a ball "
      "slides over its top at 16 mm/s in three planes, 1 N/mm.",
      {"algorithm, voxels, edge, ball", "direction, degrees: median", "99 %", "largest step, N", ""},
      {},
      {}};
  using namespace testing_support;
  for (const Case& one : kCases) {
    const bool is_coarse = one.voxel_mm > 0.25 || one.edge_voxels < 2;
    const Volume bone =
        shape_volume(centred_cube(static_cast<int>((2 * one.ball_mm + 2) / one.voxel_mm), one.voxel_mm),
                     ball(Vec3::Zero(), one.ball_mm), one.edge_voxels);
    for (const std::string& algorithm : algorithm_names()) {
      Slide felt;
      for (const double azimuth : {0.0, 0.35, 0.8}) slide(algorithm, bone, one.ball_mm, azimuth, felt);
      const double median = distribution_of(felt.direction_deg).median;
      const double p99 = percentile(felt.direction_deg, 0.99);
      const double step_N = felt.largest_step_N;
      const bool holds =
          is_coarse ? median <= 0.5 && p99 <= 1.5 : median <= 0.1 && p99 <= 0.5 && step_N <= 0.002;
      section.add_of(algorithm,
                     {fmt::format("{}, {:.2f} mm, {:.0f}, {:.0f} mm", algorithm, one.voxel_mm,
                                  one.edge_voxels, one.ball_mm),
                      figure(median), figure(p99), figure(step_N)},
                     holds);
    }
  }
  return section;
}

}  // namespace osteomill::verification
