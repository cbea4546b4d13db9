#include "osteomill/study/probe.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/study/match_stiffness.h"
#include "osteomill/study/metrics.h"

namespace osteomill {

namespace {

// Lowers the shaft in steps until its force reaches that of a leaning hand, or its centreline is half its
// radius deep.
constexpr double kPress_N = 0.5;
constexpr double kStep_mm = 0.005;

// Contact at a third of the shaft, away from both the burr and the shaft's end.
double lever_mm(const MillingTool& tool) {
  return std::max(tool.shaft_length_mm / 3, 2 * tool.burr_radius_mm);
}

double torque_error(const MillingSetup& setup, const Volume& edge) {
  const MillingTool& tool = setup.tool;
  const auto algorithm = make_algorithm(setup.algorithm, setup.haptics);
  algorithm->prepare({&edge, tool});
  const Quat lying = quaternion_from_rotation_vector({0, std::numbers::pi / 2, 0});
  const Vec3 lever(lever_mm(tool), 0, 0);
  for (double height = 2 * tool.shaft_radius_mm; height > -0.5 * tool.shaft_radius_mm; height -= kStep_mm) {
    const HapticStep step = algorithm->step({Vec3(-lever.x(), 0, height), lying}, setup.tick_s);
    if (step.wrench.force_N.norm() < kPress_N) continue;
    const Vec3 expected_Nmm = lever.cross(step.wrench.force_N);
    return (step.wrench.torque_Nmm - expected_Nmm).norm() / expected_Nmm.norm();
  }
  return kNotMeasured;
}

}  // namespace

Probe probe(const MillingSetup& setup, const Volume& wall, const Volume& edge) {
  return {felt_stiffness_N_per_mm(setup, wall), torque_error(setup, edge)};
}

}  // namespace osteomill
