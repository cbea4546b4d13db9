#include "osteomill/view/scene.h"

namespace osteomill {

namespace {

constexpr double kMinForce_N = 0.02;
constexpr int kSteps = 200;

}  // namespace

std::optional<Vec3> point_of_action(const MillingTool& tool, const Pose& X_WT, const Wrench& wrench) {
  const double force_N = wrench.force_N.norm();
  if (!(force_N > kMinForce_N)) return std::nullopt;
  const Vec3 along = wrench.force_N / force_N;
  const Vec3 lever = wrench.force_N.cross(wrench.torque_Nmm) / (force_N * force_N);
  // The force pushes the tool away from the bone: it comes from outside, against the tool.
  const double reach_mm = lever.norm() + tool.shaft_length_mm + tool.burr_radius_mm;
  const Pose X_TW = X_WT.inverse();
  for (int n = 0; n <= kSteps; ++n) {
    const double way_mm = -reach_mm + 2 * reach_mm * n / kSteps;
    const Vec3 point_W = X_WT.position_mm + lever + way_mm * along;
    const double distance_mm = tool_distance(tool, X_TW * point_W).distance_mm;
    if (distance_mm <= reach_mm / kSteps) return Vec3(point_W + std::max(distance_mm, 0.0) * along);
  }
  return Vec3(X_WT.position_mm - tool.burr_radius_mm * along);
}

std::optional<Vec3> red_point_W(const ViewScene& scene) {
  if (scene.intersection_W || !scene.X_WT) return scene.intersection_W;
  return point_of_action(scene.tool, *scene.X_WT, scene.wrench);
}

}  // namespace osteomill
