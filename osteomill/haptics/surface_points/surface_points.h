#pragma once

#include <span>
#include <vector>

#include "osteomill/haptics/haptic_algorithm.h"
#include "osteomill/haptics/surface_points/surface_points_settings.h"

namespace osteomill {

/// Algorithm 2 of Eriksson 2012: vertices on the tool's surface, each that is in bone a spring back to the
/// surface; the spheres' and slices' forces and torques go straight to the hand (direct rendering, equations
/// 14 to 21).
///
/// As the paper has it: a sphere or slice whose centre is in bone sends the force of the step before, so the
/// force has an upper limit beyond which the tool falls through, and nothing is held where the first contact
/// is already that deep; a contact of the shaft alone sends a torque and no force.
class SurfacePoints final : public HapticAlgorithm {
 public:
  /// Throws std::invalid_argument where a setting is out of range.
  explicit SurfacePoints(const SurfacePointsSettings& settings);

  void prepare(const Scene& scene) override;
  HapticStep step(const Pose& X_WD, double dt_s) override;
  void volume_changed(const VolumeChange&) override {}
  void reset() override;
  int sample_point_count() const override;

 private:
  // The vertices that share a centre: the sphere, or a slice.
  struct Fan {
    Vec3 centre_T = Vec3::Zero();
    std::vector<Vec3> vertices_T;
    // The force of the step before, for when the centre is in bone: (17), (19).
    Vec3 held_force_W_N = Vec3::Zero();
  };
  int update_force(Fan& fan, const Pose& X_WD) const;

  SurfacePointsSettings settings_;
  const Volume* volume_ = nullptr;
  Fan sphere_;
  std::vector<Fan> slices_;
};

}  // namespace osteomill
