#include <cmath>

#include <fmt/core.h>

#include "verification/probing.h"
#include "verification/sections.h"

namespace osteomill::verification {

namespace {

constexpr int kPlanes = 60;

struct OnAPlane {
  double along_N;
  double sideways_share;
  double tool_depth_mm;
};

// Presses the burr `depth_mm` deep on a plane of random slope, the shaft within 40 degrees of the normal.
OnAPlane press(std::string_view algorithm, double stiffness, double depth_mm, double edge_voxels,
               const std::vector<HapticSettings::Named>& named, SeededRandom& random) {
  using namespace testing_support;
  const Vec3 normal = random_direction(random);
  const Vec3 at = Vec3(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5));
  const Volume volume = shape_volume(centred_cube(60, 0.2), plane(at, normal), edge_voxels);
  const MillingTool tool;
  const auto felt = prepared(algorithm, volume, tool, stiffness, named);
  const Quat upright = smallest_rotation(Vec3::UnitZ(), normal);
  const Quat tilted =
      upright * quaternion_from_rotation_vector({random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 0});
  const HapticStep step =
      approach(*felt, at + 2.0 * normal, at + (tool.burr_radius_mm - depth_mm) * normal, tilted);
  const double along = step.wrench.force_N.dot(normal);
  return {along, (step.wrench.force_N - along * normal).norm() / step.wrench.force_N.norm(),
          tool.burr_radius_mm - normal.dot(step.X_WT.position_mm - at)};
}

void line_proxy_rows(Section& section) {
  for (const double edge_voxels : {1.0, 2.0, 3.0}) {
    SeededRandom random(1);
    std::vector<double> errors;
    std::vector<double> sideways;
    for (int n = 0; n < kPlanes; ++n) {
      const double depth = random.uniform(0.2, 1.2);
      // The spring acts on the centreline's tip, so the depth is the centre's.
      const OnAPlane felt =
          press("line-proxy", 1, depth + MillingTool{}.burr_radius_mm, edge_voxels, {}, random);
      errors.push_back(std::abs(felt.along_N / depth - 1));
      sideways.push_back(felt.sideways_share);
    }
    section.rows.push_back({fmt::format("1, k d, edge {:.0f} voxels", edge_voxels), median_and_worst(errors),
                            median_and_worst(sideways)});
  }
}

void point_shell_rows(Section& section) {
  const MillingTool tool;
  const double r = tool.burr_radius_mm;
  const double kA = 1.5 * 20 * 27 / (4 * std::numbers::pi * r * r * r);
  for (const int scale : {1, 3}) {
    for (const double edge_voxels : {1.0, 2.0, 3.0}) {
      SeededRandom random(2);
      std::vector<double> errors;
      std::vector<double> sideways;
      for (int n = 0; n < kPlanes; ++n) {
        const OnAPlane felt = press("point-shell", 10, random.uniform(0.8, 2.0), edge_voxels,
                                    {{"point-shell", "scale", static_cast<double>(scale)}}, random);
        const double depth = felt.tool_depth_mm;
        const double analytic = kA * std::numbers::pi * (r - depth) * depth * depth;
        errors.push_back(std::abs(felt.along_N / analytic - 1));
        sideways.push_back(felt.sideways_share);
      }
      section.rows.push_back({fmt::format("3, scale {}, edge {:.0f} voxels", scale, edge_voxels),
                              median_and_worst(errors), median_and_worst(sideways)});
    }
  }
}

}  // namespace

Section force_on_planes() {
  Section section{
      "Force on a plane",
      fmt::format(
          "Reported: the error of 1 against `k d` along the normal, and of the contact of 3 against `kA "
          "pi (r - d) d^2`, where `d` is the depth of the simulated tool. {} planes of random slope and "
          "position, 0.2 mm voxels, the shaft up to 40 degrees off the normal; relative errors, median "
          "(worst).",
          kPlanes),
      {"what", "error along the normal", "sideways"},
      {},
      {}};
  line_proxy_rows(section);
  point_shell_rows(section);
  return section;
}

}  // namespace osteomill::verification
