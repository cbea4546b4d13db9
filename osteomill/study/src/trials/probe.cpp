#include "osteomill/study/probe.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/study/match_stiffness.h"
#include "osteomill/study/metrics.h"

namespace osteomill {

namespace {

// The shaft is lowered until it is felt with as much as a hand that leans gives, or its centreline is as deep
// as half its radius.
constexpr double kPress_N = 0.5;
constexpr double kStep_mm = 0.005;

// A third of the shaft from the burr: bone touches neither the burr nor the shaft's end.
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

Volume sharp_edge(const MillingTool& tool) {
  constexpr double kVoxelsToTheRadius = 5, kHalfInRadii = 4, kEdge_voxels = 2;
  constexpr float kIsovalue = 500;
  const double spacing_mm = tool.shaft_radius_mm / kVoxelsToTheRadius;
  GridGeometry geometry;
  geometry.dims.fill(1 + 2 * static_cast<int>(kVoxelsToTheRadius * kHalfInRadii));
  geometry.spacing_mm = Vec3::Constant(spacing_mm);
  // The edge lies on no voxel.
  geometry.origin_mm = Vec3::Constant(-(kVoxelsToTheRadius * kHalfInRadii + 0.3) * spacing_mm);
  std::vector<float> densities;
  densities.reserve(geometry.voxel_count());
  for_each(geometry.all_voxels(), [&](const VoxelIndex& voxel) {
    const Vec3 p = geometry.world_from_voxel(voxel);
    const double above_mm = (p.z() + std::abs(p.x())) / std::numbers::sqrt2;
    const double share = std::clamp(0.5 - above_mm / (kEdge_voxels * spacing_mm), 0.0, 1.0);
    densities.push_back(static_cast<float>(2 * kIsovalue * share));
  });
  return Volume(DensityGrid(geometry, std::move(densities)), kIsovalue);
}

Probe probe(const MillingSetup& setup, const Volume& wall, const Volume& edge) {
  return {felt_stiffness_N_per_mm(setup, wall), torque_error(setup, edge)};
}

}  // namespace osteomill
