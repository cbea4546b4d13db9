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

/// The box along the grid's axes that holds all bone (all of the grid if there is none).
struct BoneBox {
  std::array<Vec3, 8> corners_W;

  Vec3 centre_W() const { return 0.5 * (corners_W.front() + corners_W.back()); }
  Sphere bounds() const;
};
/// Goes through every voxel.
BoneBox box_of_bone(const Volume& bone);

/// Returns a line on why the tool cannot work with this bone; empty if it can.
std::string tool_fault(const MillingTool& tool, const BoneBox& box);

/// The camera turned as it is, with all of the bone between the panels.
Camera showing_whole(Camera camera, const BoneBox& box, const PixelSize& size);

/// All of the bone upright by the patient's axes: from the front, or from the left if the bone is deeper
/// than wide, a little from above and aside.
Camera first_camera(const BoneBox& box, const PixelSize& size);

/// The view into which the target's surface faces, with all of the bone.
Camera camera_on_target(const PlacedExercise& exercise, const BoneBox& box, const PixelSize& size);

/// Returns the point of bone that is seen at a pixel, on its surface or on one of these cuts; nothing if no
/// bone is.
std::optional<Vec3> bone_point_seen_at(const Volume& bone, const Camera& camera, const PixelSize& size,
                                       const Eigen::Vector2d& pixel, std::span<const ClipPlane> cuts);
/// Returns a voxel of the bone that is seen at a pixel, of what these cuts leave; nothing if no bone is.
std::optional<VoxelIndex> bone_voxel_seen_at(const Volume& bone, const Camera& camera, const PixelSize& size,
                                             const Eigen::Vector2d& pixel, std::span<const ClipPlane> cuts);

/// The tool free of bone, before the point of bone that is seen at a pixel; nothing if no bone is.
std::optional<Pose> tool_pose_before(const Volume& bone, const MillingTool& tool, const Camera& camera,
                                     const PixelSize& size, double x_px, double y_px);
/// Returns the same in the middle of the view, or `above_px` above it; if there is no bone, the pose as if
/// there were.
Pose tool_pose_before_middle(const Volume& bone, const MillingTool& tool, const Camera& camera,
                             const PixelSize& size, double above_px = 0);

}  // namespace osteomill::app
