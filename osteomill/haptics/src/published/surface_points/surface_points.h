#pragma once

#include <string>
#include <vector>

#include "osteomill/haptics/algorithm_description.h"
#include "osteomill/haptics/haptic_algorithm.h"
#include "osteomill/haptics/sample_points.h"

namespace osteomill::surface_points {

/// Holds the settings of algorithm 2; surface_points_description.cpp gives each its meaning, range and
/// default.
struct Settings {
  double stiffness_N_per_mm = 20;
  int slices = 20;
  int sphere_vertices = kSphereVertices;
  int circle_vertices = kSliceVertices;
};

/// Returns a_i of (15): from `vertex_W`, in bone, towards the centre `centre_W`, outside it, as far as the
/// surface, which is taken to be where the density between them would cross the isovalue. Zero if the vertex
/// is not in bone. Safe in the haptic tick.
Vec3 spring_to_surface(const Volume& volume, const Vec3& vertex_W, const Vec3& centre_W);

/// Renders algorithm 2 of Eriksson 2012 (section 5): vertices on the tool's surface, each that is in bone a
/// spring back to the surface; the springs' forces and torques go straight to the hand (direct rendering,
/// equations 14 to 21).
///
/// A sphere or slice whose centre is in bone sends the force of the step before, so the force has an upper
/// limit beyond which the tool falls through, and nothing is held if the first contact is already that deep;
/// a contact of the shaft alone sends a torque and no force. The simulated tool is the device.
///
/// Chosen where the paper is silent:
/// - the fraction of (15) is measured from the vertex (figure 12); as printed it would shrink the force as
///   the tool sinks in;
/// - slices are the middles of equal lengths of the free shaft, from where it leaves the burr.
class SurfacePoints final : public HapticAlgorithm {
 public:
  /// Takes settings within their ranges.
  explicit SurfacePoints(const Settings& settings) : settings_(settings) {}

  std::vector<std::string> setting_warnings(const MillingTool& tool, const GridGeometry& scan) const override;
  void prepare(const AlgorithmInputs& inputs) override;
  HapticStep step(const Pose& X_WD, double dt_s) noexcept override;
  /// Does nothing: every step reads the volume itself.
  void volume_changed(const VolumeChange&) noexcept override {}
  void reset() noexcept override;
  int sample_point_count() const override;

 private:
  // The vertices that share a centre: the sphere, or a slice of the shaft.
  struct VertexRing {
    Vec3 centre_T = Vec3::Zero();
    // From the centre to each vertex.
    std::vector<Vec3> vertex_offsets_T;
    // The force of this step or, if the centre is in bone, of the last step when it was not: (17), (19).
    Vec3 force_W_N = Vec3::Zero();
    // Always of this step.
    int contacts = 0;
  };
  void update(VertexRing& ring, const Pose& X_WD) const;

  Settings settings_;
  const Volume* volume_ = nullptr;
  VertexRing sphere_;
  std::vector<VertexRing> slices_;
};

/// Describes algorithm 2 of the paper (section 5).
AlgorithmDescription description();

}  // namespace osteomill::surface_points
