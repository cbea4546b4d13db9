#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "osteomill/exercise/placed_exercise.h"
#include "osteomill/haptics/milling_tool.h"
#include "osteomill/visual/camera.h"
#include "osteomill/visual/clip_face.h"
#include "osteomill/volume/volume.h"

namespace osteomill::app {

/// Bounding box of the bone along the grid's axes (the whole grid if there is no bone).
struct BoneBox {
  std::array<Vec3, 8> corners_W;

  Vec3 centre_W() const { return 0.5 * (corners_W.front() + corners_W.back()); }
  Sphere bounds() const;
};
/// Scans every voxel.
BoneBox box_of_bone(const Volume& bone);

/// Returns one line on why the tool cannot work with this bone; empty if it can.
std::string tool_fault(const MillingTool& tool, const BoneBox& box);

/// Returns the camera moved, without turning it, so that the whole bone fits between the panels.
Camera fit_bone(Camera camera, const BoneBox& box, const PixelSize& size);

/// Returns a view of the whole bone, upright by the patient's axes: from the front, or from the left if the
/// bone is deeper than wide, slightly from above and from the side.
Camera initial_camera(const BoneBox& box, const PixelSize& size);

/// Returns a view of the whole bone, facing the target's surface.
Camera camera_on_target(const PlacedExercise& exercise, const BoneBox& box, const PixelSize& size);

/// Returns the bone point visible at a pixel, on its surface or on one of these cuts; std::nullopt if none.
std::optional<Vec3> bone_point_seen_at(const Volume& bone, const Camera& camera, const PixelSize& size,
                                       const Eigen::Vector2d& pixel, std::span<const ClipPlane> cuts);
/// Returns a voxel of the bone visible at a pixel, given these cuts; std::nullopt if none.
std::optional<VoxelIndex> bone_voxel_seen_at(const Volume& bone, const Camera& camera, const PixelSize& size,
                                             const Eigen::Vector2d& pixel, std::span<const ClipPlane> cuts);

/// Returns a tool pose free of bone in front of the bone point visible at a pixel; std::nullopt if none.
std::optional<Pose> tool_pose_in_front_of(const Volume& bone, const MillingTool& tool, const Camera& camera,
                                          const PixelSize& size, double x_px, double y_px);
/// Returns such a pose at the centre of the view, or `above_px` above it; without bone there, the pose as if
/// there were.
Pose tool_pose_at_centre(const Volume& bone, const MillingTool& tool, const Camera& camera,
                         const PixelSize& size, double above_px = 0);

}  // namespace osteomill::app
