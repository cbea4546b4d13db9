#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"
#include "osteomill/haptics/milling_tool.h"
#include "osteomill/visual/camera.h"
#include "osteomill/volume/bone_densities.h"

namespace osteomill {

/// Clip plane: removes the points p of W with normal . p < offset from the picture.
struct ClipPlane {
  Vec3 normal_W = Vec3::UnitZ();
  double offset_mm = 0;
  friend bool operator==(const ClipPlane&, const ClipPlane&) = default;
};
/// Maximum number of clip planes of a scene.
inline constexpr std::size_t kMaxClipPlanes = 4;

/// Everything a picture shows in addition to the bone; all in W.
struct ViewScene {
  Camera camera;
  /// Bounds of the bone; objects far outside it are not drawn.
  Sphere bounds;
  MillingTool tool;
  /// The simulated tool, and the device pose as a ghost visible through the bone. Each is drawn only if set.
  std::optional<Pose> X_WT;
  std::optional<Pose> X_WD;
  /// Draws bone between the eye and the simulated tool translucent.
  bool see_through = false;
  /// Wrench on the hand, drawn as arrows at the simulated burr.
  Wrench wrench;
  /// Intersection point (HapticStep::intersection_W), if the algorithm has one.
  std::optional<Vec3> intersection_W;
  std::array<std::optional<ClipPlane>, kMaxClipPlanes> cuts;
  /// Colours labelled bone by label.
  bool show_labels = true;
  /// Densities that colour unlabelled bone: pale at the reference (dentine), white if much denser (enamel),
  /// reddish near the isovalue.
  double isovalue = 0;
  double reference_density = 1;
  /// RGB of the light reflected from the surroundings below: weak if they are dark.
  std::array<float, 3> light_from_below{0.20f, 0.17f, 0.16f};
};

/// Length of force arrows.
inline constexpr double kArrow_mm_per_N = 3.0;
/// Length of torque arrows.
inline constexpr double kArrow_mm_per_Nmm = 0.4;

/// Returns the surface point of the tool at which a single force equivalent to the wrench, as far as one
/// exists, enters the tool. If its line of action misses the tool, returns the burr point that faces the
/// force; std::nullopt if the force is negligible.
std::optional<Vec3> point_of_action(const MillingTool& tool, const Pose& X_WT, const Wrench& wrench);

/// Returns the position of the red point: the algorithm's intersection point, as in figure 4 of the paper;
/// without one, the wrench's point of action on the simulated tool, if any.
std::optional<Vec3> red_point_W(const ViewScene& scene);

}  // namespace osteomill
