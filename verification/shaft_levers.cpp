#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "verification/probing.h"
#include "verification/sections.h"

namespace osteomill::verification {

namespace {

constexpr int kOrientations = 12;

struct OnAnEdge {
  double force_N;
  double torque_error_share;
  bool turns_away;
};

// Presses the shaft 0.3 mm deep on the crest of a square edge, `lever_mm` from the burr, in a scene rotated
// randomly against the grid.
OnAnEdge press(std::string_view algorithm, double lever_mm, double edge_voxels, SeededRandom& random) {
  using namespace testing_support;
  const Quat turn = random_orientation(random);
  const Vec3 left = turn * Vec3(1, 0, 1).normalized();
  const Vec3 right = turn * Vec3(-1, 0, 1).normalized();
  const Volume volume = shape_volume(
      centred_cube(64, 0.2), [&](const Vec3& p) { return std::max(left.dot(p), right.dot(p)); }, edge_voxels);
  const MillingTool tool;
  const auto felt = prepared(algorithm, volume, tool, algorithm == "surface-points" ? 20 : 2);
  const Quat lying = turn * quaternion_from_rotation_vector({0, std::numbers::pi / 2, 0});
  const bool centreline = algorithm == "line-proxy";
  const double deep = centreline ? -0.3 : tool.shaft_radius_mm - 0.3;
  const HapticStep step =
      approach(*felt, turn * Vec3(-lever_mm, 0, 2), turn * Vec3(-lever_mm, 0, deep), lying);
  const Vec3 lever = turn * Vec3(lever_mm, 0, 0);
  const Vec3 expected = lever.cross(step.wrench.force_N);
  return {step.wrench.force_N.norm(), (step.wrench.torque_Nmm - expected).norm() / expected.norm(),
          step.wrench.torque_Nmm.dot(lever.cross(turn * Vec3::UnitZ())) > 0};
}

}  // namespace

Section shaft_levers() {
  Section section{
      "The shaft alone on an edge",
      fmt::format(
          "Must hold for 4: torque = lever x force within 1 %, with the right sign, and a force that is "
          "felt. The shaft lies across the crest of a square edge, 0.3 mm deep (algorithm 1: its "
          "centreline), in {} random orientations of the scene; 0.2 mm voxels; torque error relative to "
          "lever x force, median (worst).",
          kOrientations),
      {"algorithm, lever, edge", "torque error", "least force, N", ""},
      {},
      {}};
  for (const std::string& algorithm : algorithm_names()) {
    for (const double edge_voxels : {1.0, 2.0}) {
      for (const double lever_mm : {4.0, 8.0, 12.0, 20.0}) {
        SeededRandom random(3);
        std::vector<double> errors;
        double min_N = 1e9;
        bool right_sign = true;
        constexpr double kMost = 0.01;
        for (int n = 0; n < kOrientations; ++n) {
          const OnAnEdge felt = press(algorithm, lever_mm, edge_voxels, random);
          errors.push_back(felt.torque_error_share);
          min_N = std::min(min_N, felt.force_N);
          right_sign = right_sign && felt.turns_away;
        }
        section.add_of(algorithm,
                       {fmt::format("{}, {:.0f} mm, {:.0f} voxels", algorithm, lever_mm, edge_voxels),
                        median_and_worst(errors), figure(min_N)},
                       right_sign && min_N > 0.01 && percentile(errors, 1) <= kMost);
      }
    }
  }
  return section;
}

}  // namespace osteomill::verification
