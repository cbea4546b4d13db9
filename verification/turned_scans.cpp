#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "verification/probing.h"
#include "verification/sections.h"

namespace osteomill::verification {

namespace {

constexpr int kTurns = 10;
constexpr int kTicks = 400;
constexpr double kBall_mm = 5;
constexpr double kHole_mm = 2;

// Signed distance to a ball with a hole from its top, in which the burr can stand while the shaft leans on
// the rim.
double distance_to_holed_ball_mm(const Vec3& p) {
  const double above_floor = std::max(0.0, -p.z());
  const double into_hole = kHole_mm - std::hypot(p.x(), p.y(), above_floor);
  return std::max(p.norm() - kBall_mm, into_hole);
}

Volume holed_ball(const Quat& turn, bool grid_turns_too) {
  using namespace testing_support;
  GridGeometry grid = centred_cube(96, 0.125);
  if (grid_turns_too) {
    grid.direction = turn.toRotationMatrix();
    grid.origin_mm = turn * grid.origin_mm;
  }
  return shape_volume(grid, [&](const Vec3& p) { return distance_to_holed_ball_mm(turn.conjugate() * p); });
}

// Path of the tool: down, slightly into the hole's floor, then tilting until the shaft presses on the rim.
Pose stand_and_lean(double progress) {
  const double down = std::min(1.0, 2 * progress);
  const double lean = std::max(0.0, progress - 0.5);
  return {{0, 0, 0.5 - 1.4 * down}, quaternion_from_rotation_vector({0.1 * lean, 0.9 * lean, 0})};
}

struct Difference {
  double force_share;
  double torque_share;
};

// Returns the largest differences between two runs whose bones and poses differ by the rotation `turn`,
// relative to the largest wrench.
Difference difference(std::string_view algorithm, const Volume& straight, const Volume& turned,
                      const Quat& turn) {
  const MillingTool tool;
  const double stiffness = algorithm == "surface-points" ? 20 : 2;
  const auto a = prepared(algorithm, straight, tool, stiffness);
  const auto b = prepared(algorithm, turned, tool, stiffness);
  double max_N = 0;
  double max_Nmm = 0;
  double off_N = 0;
  double off_Nmm = 0;
  for (int n = 0; n < kTicks; ++n) {
    const Pose X = stand_and_lean(n / double{kTicks});
    const Wrench one = a->step(X, kTick_s).wrench;
    const Wrench two = b->step({turn * X.position_mm, turn * X.orientation}, kTick_s).wrench;
    max_N = std::max(max_N, one.force_N.norm());
    max_Nmm = std::max(max_Nmm, one.torque_Nmm.norm());
    off_N = std::max(off_N, (turn * one.force_N - two.force_N).norm());
    off_Nmm = std::max(off_Nmm, (turn * one.torque_Nmm - two.torque_Nmm).norm());
  }
  return {off_N / max_N, off_Nmm / max_Nmm};
}

}  // namespace

Section turned_scans() {
  Section section{
      "Rotating scan and poses together",
      fmt::format(
          "Must hold for 4: the wrench rotates with them, within 0.002 of the largest if the grid is "
          "rotated too, and within a tenth, the voxel error, if the bone is rotated in the grid. {} "
          "random rotations; the burr stands in a hole of 4 mm in a ball, then the shaft leans on the "
          "rim; 0.125 mm voxels; largest difference over {} ticks relative to the largest wrench, "
          "median (worst).",
          kTurns, kTicks),
      {"algorithm, what is turned", "force", "torque", "at most", ""},
      {},
      {}};
  const Volume straight = holed_ball(Quat::Identity(), false);
  for (const std::string& algorithm : algorithm_names()) {
    for (const bool grid_turns_too : {true, false}) {
      SeededRandom random(4);
      std::vector<double> force;
      std::vector<double> torque;
      for (int n = 0; n < kTurns; ++n) {
        const Quat turn = random_orientation(random);
        const Difference off = difference(algorithm, straight, holed_ball(turn, grid_turns_too), turn);
        force.push_back(off.force_share);
        torque.push_back(off.torque_share);
      }
      const double max = grid_turns_too ? 0.002 : 0.1;
      section.add_of(algorithm,
                     {fmt::format("{}, {}", algorithm, grid_turns_too ? "grid" : "bone"),
                      median_and_worst(force), median_and_worst(torque), figure(max)},
                     percentile(force, 1) <= max && percentile(torque, 1) <= max);
    }
  }
  return section;
}

}  // namespace osteomill::verification
