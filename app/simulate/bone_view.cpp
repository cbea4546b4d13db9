#include "app/simulate/bone_view.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "osteomill/session/milling_entry.h"
#include "osteomill/visual/clip_face.h"
#include "osteomill/volume/sampling.h"

#include "app/simulate/widgets.h"

namespace osteomill::app {

namespace {

// Width of the panels on both sides, and the fraction of the remaining space that the bone fills.
constexpr float kPanels_px = 616;
constexpr double kFilled = 0.85;
constexpr double kAside_rad = 0.5;
constexpr double kAbove_rad = 0.35;

VoxelBox voxels_of_bone(const Volume& bone) {
  VoxelBox box;
  for_each_bone_voxel(bone, [&](const VoxelIndex& v) { box.include(v); });
  return box.empty() ? bone.geometry().all_voxels() : box;
}

}  // namespace

Sphere BoneBox::bounds() const {
  return {centre_W(), std::max(0.5 * (corners_W.back() - corners_W.front()).norm(), 1.0)};
}

BoneBox box_of_bone(const Volume& bone) {
  return {corners_W(bone.geometry(), voxels_of_bone(bone))};
}

std::string tool_fault(const MillingTool& tool, const BoneBox& box) {
  const double widest_mm = (box.corners_W.back() - box.corners_W.front()).norm();
  const double radius_mm = std::max(tool.burr_radius_mm, tool.shaft_radius_mm);
  if (2 * radius_mm <= widest_mm) return {};
  return fmt::format("{} of {:g} mm radius is wider than the whole bone, {:.3g} mm",
                     tool.burr_radius_mm == radius_mm ? "a burr" : "a shaft", radius_mm, widest_mm);
}

Camera fit_bone(Camera camera, const BoneBox& box, const PixelSize& size) {
  camera.focus_W = box.centre_W();
  const double up = std::tan(0.5 * camera.field_of_view_rad) * kFilled;
  // In a narrow window the panels would leave no space.
  const double free_px = std::max(size.width - static_cast<double>(ui::px(kPanels_px)), 0.3 * size.width);
  const double across = up * free_px / size.height;
  camera.distance_mm = 2;
  for (const Vec3& corner_W : box.corners_W) {
    const Vec3 corner = camera.orientation.conjugate() * (corner_W - camera.focus_W);
    const double away_mm = std::max(std::abs(corner.x()) / across, std::abs(corner.y()) / up);
    camera.distance_mm = std::max(camera.distance_mm, corner.z() + away_mm);
  }
  return camera;
}

Camera initial_camera(const BoneBox& box, const PixelSize& size) {
  Vec3 extent_mm = Vec3::Zero();
  for (const Vec3& corner_W : box.corners_W) {
    extent_mm = extent_mm.cwiseMax(2 * (corner_W - box.centre_W()).cwiseAbs());
  }
  // W is LPS: +x to the patient's left, +y to the back.
  const Vec3 left = Vec3::UnitX();
  const Vec3 front = -Vec3::UnitY();
  const bool from_left = extent_mm.y() > extent_mm.x();
  const Vec3 level = from_left ? Vec3(std::cos(kAside_rad) * left + std::sin(kAside_rad) * front)
                               : Vec3(std::cos(kAside_rad) * front + std::sin(kAside_rad) * left);
  const Vec3 towards_viewer = std::cos(kAbove_rad) * level + std::sin(kAbove_rad) * Vec3::UnitZ();
  return fit_bone(camera_on(box.bounds(), -towards_viewer, Vec3::UnitZ()), box, size);
}

Camera camera_on_target(const PlacedExercise& exercise, const BoneBox& box, const PixelSize& size) {
  // Tilted, so that depth is visible: a view from above towards the front, one from a side upwards.
  constexpr double kTilt_rad = 0.45;
  const Vec3& outward_W = exercise.outward_W;
  const bool is_above = std::abs(outward_W.z()) > 0.5;
  const Vec3 up_W = is_above ? Vec3::UnitY() : Vec3::UnitZ();
  const Vec3 aside_W = up_W.cross(outward_W).normalized();
  const Vec3 towards_W = Eigen::AngleAxisd(is_above ? kTilt_rad : -kTilt_rad, aside_W) * outward_W;
  return fit_bone(camera_on(box.bounds(), -towards_W, up_W), box, size);
}

namespace {

// The part of a line of sight that can hit bone.
struct Sight {
  Vec3 from_W;
  Vec3 to_W;
};

std::optional<Sight> sight_through(const GridGeometry& geometry, const Camera& camera, const Vec3& ray_W) {
  const Vec3 last = Vec3(geometry.dims[0] - 1, geometry.dims[1] - 1, geometry.dims[2] - 1);
  const Vec3 centre_W = geometry.world_from_voxel(Vec3(0.5 * last));
  const double radius_mm =
      0.5 * geometry.spacing_mm.cwiseProduct(last).norm() + 2 * geometry.spacing_mm.maxCoeff();
  const double middle_mm = ray_W.dot(centre_W - camera.eye_W());
  if (middle_mm + radius_mm <= 0) return std::nullopt;
  return Sight{camera.eye_W() + std::max(0.0, middle_mm - radius_mm) * ray_W,
               camera.eye_W() + (middle_mm + radius_mm) * ray_W};
}

// Returns the part that the cut leaves.
std::optional<Sight> beyond(const Sight& sight, const ClipPlane& cut) {
  const double from_mm = cut.normal_W.dot(sight.from_W) - cut.offset_mm;
  const double to_mm = cut.normal_W.dot(sight.to_W) - cut.offset_mm;
  if (from_mm < 0 && to_mm < 0) return std::nullopt;
  if (from_mm >= 0 && to_mm >= 0) return sight;
  const Vec3 on_cut_W = sight.from_W + from_mm / (from_mm - to_mm) * (sight.to_W - sight.from_W);
  return from_mm < 0 ? Sight{on_cut_W, sight.to_W} : Sight{sight.from_W, on_cut_W};
}

}  // namespace

std::optional<Vec3> bone_point_seen_at(const Volume& bone, const Camera& camera, const PixelSize& size,
                                       const Eigen::Vector2d& pixel, std::span<const ClipPlane> cuts) {
  auto sight = sight_through(bone.geometry(), camera, ray_through(camera, size, pixel.x(), pixel.y()));
  for (const ClipPlane& cut : cuts)
    if (sight) sight = beyond(*sight, cut);
  return sight ? first_crossing(bone, sight->from_W, sight->to_W) : std::nullopt;
}

std::optional<VoxelIndex> bone_voxel_seen_at(const Volume& bone, const Camera& camera, const PixelSize& size,
                                             const Eigen::Vector2d& pixel, std::span<const ClipPlane> cuts) {
  const GridGeometry& geometry = bone.geometry();
  const auto point_W = bone_point_seen_at(bone, camera, size, pixel, cuts);
  if (!point_W) return std::nullopt;
  const Vec3 point = geometry.voxel_from_world(*point_W);
  const VoxelIndex middle{static_cast<int>(std::lround(point.x())), static_cast<int>(std::lround(point.y())),
                          static_cast<int>(std::lround(point.z()))};
  std::optional<VoxelIndex> nearest;
  double nearest_mm = 0;
  for_each(VoxelBox{middle, middle}.grown(1), [&](const VoxelIndex& v) {
    const double away_mm = (geometry.world_from_voxel(v) - *point_W).norm();
    if (!bone.is_bone_in_grid(v) || (nearest && away_mm >= nearest_mm)) return;
    nearest = v;
    nearest_mm = away_mm;
  });
  return nearest;
}

std::optional<Pose> tool_pose_in_front_of(const Volume& bone, const MillingTool& tool, const Camera& camera,
                                          const PixelSize& size, double x_px, double y_px) {
  const auto point_W = bone_point_seen_at(bone, camera, size, {x_px, y_px}, {});
  if (!point_W) return std::nullopt;
  const Vec3 ray_W = ray_through(camera, size, x_px, y_px);
  // In front of the point, towards the eye, so that the tool appears at the pixel.
  const Vec3 right_W = camera.up_W().cross(-ray_W).normalized();
  return free_pose_before(bone, tool, *point_W, -ray_W, -ray_W.cross(right_W));
}

Pose tool_pose_at_centre(const Volume& bone, const MillingTool& tool, const Camera& camera,
                         const PixelSize& size, double above_px) {
  const auto X_WT =
      tool_pose_in_front_of(bone, tool, camera, size, 0.5 * size.width, 0.5 * size.height - above_px);
  if (X_WT) return *X_WT;
  if (above_px != 0) return tool_pose_at_centre(bone, tool, camera, size);
  return free_pose_before(bone, tool, camera.focus_W, camera.towards_viewer_W(), camera.up_W());
}

}  // namespace osteomill::app
