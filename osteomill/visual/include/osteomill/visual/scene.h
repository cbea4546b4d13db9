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

/// A cut through the picture: everything on one side of a plane is cut away, the points p of W with
/// normal . p < offset.
struct ClipPlane {
  Vec3 normal_W = Vec3::UnitZ();
  double offset_mm = 0;
  friend bool operator==(const ClipPlane&, const ClipPlane&) = default;
};
/// The number of cuts that a scene may have.
inline constexpr std::size_t kMaxClipPlanes = 4;

/// Everything that a picture shows beside the bone, all in W.
struct ViewScene {
  Camera camera;
  /// Holds the bone; what lies far outside it is not drawn.
  Sphere bounds;
  MillingTool tool;
  /// The simulated tool, and the device as a ghost that shows through the bone. Either is drawn only if
  /// given.
  std::optional<Pose> X_WT;
  std::optional<Pose> X_WD;
  /// Bone between the eye and the simulated tool is translucent.
  bool see_through = false;
  /// The wrench as it acts on the hand, drawn as arrows from the simulated burr.
  Wrench wrench;
  /// The intersection point (HapticStep::intersection_W), if the algorithm has one.
  std::optional<Vec3> intersection_W;
  std::array<std::optional<ClipPlane>, kMaxClipPlanes> cuts;
  /// Bone that has a label is shown in the label's colour.
  bool show_labels = true;
  /// The densities by which other bone is coloured: pale at the reference (dentine), white if much denser
  /// (enamel), reddish if hardly bone.
  double isovalue = 0;
  double reference_density = 1;
  /// Red, green and blue of the light that the surroundings throw back from below: little if they are dark.
  std::array<float, 3> light_from_below{0.20f, 0.17f, 0.16f};
};

/// A force arrow's length per newton.
inline constexpr double kArrow_mm_per_N = 3.0;
/// A torque arrow's length per newton millimetre.
inline constexpr double kArrow_mm_per_Nmm = 0.4;

/// Returns the point of the tool's surface at which the wrench's force alone would give the wrench, as far as
/// one force can: where the line along which it would act enters the tool. If that line misses the tool,
/// returns the point of the burr that faces the force; nothing if there is hardly any force.
std::optional<Vec3> point_of_action(const MillingTool& tool, const Pose& X_WT, const Wrench& wrench);

/// Returns the place of the red point: the algorithm's intersection point, as in figure 4 of the paper; if it
/// has none, the wrench's point of action on the simulated tool, if there is one.
std::optional<Vec3> red_point_W(const ViewScene& scene);

}  // namespace osteomill
