#include <cmath>

#include "verification/probing.h"
#include "verification/sections.h"
#include <fmt/core.h>

#include "osteomill/haptics/point_shell/point_shell_description.h"

namespace osteomill::verification {

namespace {

constexpr int kPlanes = 60;

struct OnAPlane {
  double along_N;
  double sideways_share;
  double tool_depth_mm;
};

// One press of the burr on a plane of random slope, `depth_mm` deep, the shaft within 40 degrees of upright.
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
      // The spring acts on the centreline's tip: its depth is the centre's own.
      const OnAPlane felt =
          press("line-proxy", 1, depth + MillingTool{}.burr_radius_mm, edge_voxels, {}, random);
      errors.push_back(std::abs(felt.along_N / depth - 1));
      sideways.push_back(felt.sideways_share);
    }
    const bool holds = percentile(errors, 1) <= 0.005 && percentile(sideways, 1) <= 0.01;
    section.add({fmt::format("1, k d, edge {:.0f} voxels", edge_voxels), median_and_worst(errors),
                 median_and_worst(sideways), "0.005, 0.01"},
                holds);
  }
}

void point_shell_rows(Section& section) {
  // The contact at the least stiffness that the no-pull-through rule allows, so that depths are voxels.
  const HapticSettings::Named soft{"point-shell", "greatest-depth", 0};
  point_shell::Settings settings = point_shell::Settings::defaults(Mode::steady);
  settings.max_depth_mm = 0;
  const MillingTool tool;
  const double kA = contact_stiffness_N_per_mm3(settings, tool);
  for (const int scale : {1, 3}) {
    for (const double edge_voxels : {1.0, 2.0, 3.0}) {
      SeededRandom random(2);
      std::vector<double> errors;
      std::vector<double> sideways;
      for (int n = 0; n < kPlanes; ++n) {
        const OnAPlane felt = press("point-shell", 10, random.uniform(0.8, 2.0), edge_voxels,
                                    {soft, {"point-shell", "scale", static_cast<double>(scale)}}, random);
        const double depth = felt.tool_depth_mm;
        const double analytic = kA * std::numbers::pi * (tool.burr_radius_mm - depth) * depth * depth;
        errors.push_back(std::abs(felt.along_N / analytic - 1));
        sideways.push_back(felt.sideways_share);
      }
      section.add({fmt::format("3, scale {}, edge {:.0f} voxels", scale, edge_voxels),
                   median_and_worst(errors), median_and_worst(sideways), "0.05"},
                  percentile(errors, 1) <= 0.05);
    }
  }
}

}  // namespace

Section force_on_planes() {
  Section section{
      "Force on a plane",
      fmt::format("Must hold: algorithm 1 gives `k d` along the normal within 0.5 % and less than 1 % "
                  "sideways; the contact of 3 gives `kA pi (r - d) d^2` within 5 %, `d` the depth of "
                  "the simulated tool. {} planes of random slope and place, 0.2 mm voxels, the shaft up "
                  "to 40 degrees off the normal; errors as shares, median (worst).",
                  kPlanes),
      {"what", "error along the normal", "sideways", "at most", ""},
      {},
      {}};
  line_proxy_rows(section);
  point_shell_rows(section);
  return section;
}

}  // namespace osteomill::verification
