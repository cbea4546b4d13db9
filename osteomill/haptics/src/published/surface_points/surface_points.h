#pragma once

#include <string>
#include <vector>

#include "osteomill/haptics/algorithm_description.h"
#include "osteomill/haptics/haptic_algorithm.h"
#include "osteomill/haptics/sample_points.h"

namespace osteomill::surface_points {

/// Settings of algorithm 2; surface_points_description.cpp gives their meaning, ranges and defaults.
struct Settings {
  double stiffness_N_per_mm = 20;
  int slices = 20;
  int sphere_vertices = kSphereVertices;
  int circle_vertices = kSliceVertices;
};

/// Returns a_i of (15): the vector from `vertex_W`, in bone, towards `centre_W`, outside it, up to the
/// surface, which is taken to be where linear interpolation of the two densities gives the isovalue. Zero if
/// the vertex is not in bone. Safe in the haptic tick.
Vec3 spring_to_surface(const Volume& volume, const Vec3& vertex_W, const Vec3& centre_W);

/// Algorithm 2 of Eriksson 2012 (section 5): each vertex on the tool's surface that is in bone acts as a
/// spring back to the surface; the springs' forces and torques go straight to the hand (direct rendering,
/// equations 14 to 21).
///
/// A sphere or slice whose centre is in bone repeats the force of the previous step, so the force has an
/// upper limit beyond which the tool falls through, and nothing is held if the first contact is already that
/// deep. A contact of the shaft alone gives a torque and no force. The simulated tool is the device.
///
/// Chosen where the paper is silent:
/// - the fraction of (15) is measured from the vertex (figure 12); as printed, the force would decrease with
///   penetration depth;
/// - slices are the middles of equal lengths of the free shaft, starting where it emerges from the burr.
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
  // Vertices with a common centre: the sphere, or a slice of the shaft.
  struct VertexRing {
    Vec3 centre_T = Vec3::Zero();
    // Offsets from the centre to each vertex.
    std::vector<Vec3> vertex_offsets_T;
    // Force of this step or, if the centre is in bone, of the last step in which it was not: (17), (19).
    Vec3 force_W_N = Vec3::Zero();
    // Always those of this step.
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
