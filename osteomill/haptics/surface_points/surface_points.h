#pragma once

#include <optional>
#include <vector>

#include "osteomill/haptics/haptic_algorithm.h"
#include "osteomill/haptics/surface_points/held_tool.h"
#include "osteomill/haptics/surface_points/surface_points_description.h"
#include "osteomill/tool/burr_presses.h"

namespace osteomill::surface_points {

/// Algorithm 2 of Eriksson 2012: vertices on the tool's surface, each that is in bone a spring back to the
/// surface; the springs' forces and torques go straight to the hand (direct rendering, equations 14 to 21).
///
/// As the paper has it, a sphere or slice whose centre is in bone sends the force of the step before, so the
/// force has an upper limit beyond which the tool falls through, and nothing is held where the first contact
/// is already that deep; a contact of the shaft alone sends a torque and no force. `Settings`
/// says what `steady` does instead.
class SurfacePoints final : public HapticAlgorithm {
 public:
  /// Throws std::invalid_argument where a setting is out of range.
  explicit SurfacePoints(const Settings& settings);

  void prepare(const Scene& scene) override;
  HapticStep step(const Pose& X_WD, double dt_s) override;
  void volume_changed(const VolumeChange&) override {}
  void reset() override;
  int sample_point_count() const override;

 private:
  // The vertices that share a centre: the sphere, a circle of the shaft, or the shaft's end.
  struct Fan {
    bool is_ring = false;
    Vec3 centre_T = Vec3::Zero();
    // From the centre to each vertex.
    std::vector<Vec3> arms_T;
    double longest_arm_mm = 0;
    // Of this step or, where the centre is in bone, of the last step when it was not: (17), (19).
    Vec3 force_W_N = Vec3::Zero();
    // From the device's centre back to where bone stopped the held tool's way to it.
    Vec3 held_back_W_mm = Vec3::Zero();
    int contacts = 0;
    std::size_t deepest_arm = 0;
    double deepest_mm = 0;
    // From the centre along the shaft to where it is pushed.
    double pushed_at_mm = 0;
  };
  struct ShaftSum {
    Wrench mean;
    int contacts = 0;
  };
  void prepare_shaft();
  int rings() const;
  double beyond_N_per_mm() const;
  ShaftSum shaft_sum(const Pose& X_WD, const Pose& X_WH);
  void add_end(const Pose& X_WD, const Pose& X_WH, ShaftSum& sum);
  void update(Fan& fan, const Pose& X_WD, const Pose& X_WH) const;
  double free_about_held_mm(const Fan& fan) const;
  std::optional<Vec3> held_centre(const Fan& fan, const Pose& X_WD, const Pose& X_WH) const;
  Vec3 reach_of(const Vec3& vertex_W, const Vec3& centre_W, double free_mm) const;
  Vec3 sum_of_reaches(Fan& fan, const Quat& orientation, const Vec3& centre_W, double free_mm) const;
  double pushed_at_mm(const Fan& ring, const Quat& orientation, const Vec3& centre_W, double free_mm) const;
  bool in_bone(const Vec3& point_W) const;
  Vec3 soften(const Vec3& force_N) const;
  Vec3 damped(const Vec3& force_N, const Vec3& overlap_W_mm, double dt_s);

  Settings settings_;
  const Volume* volume_ = nullptr;
  MillingTool tool_;
  HeldTool held_tool_;
  PressingBurr burr_;
  // From the held tool's burr to the device's, and its filtered rate.
  Vec3 last_overlap_W_mm_ = Vec3::Zero();
  Vec3 overlap_rate_W_mm_s_ = Vec3::Zero();
  Fan sphere_;
  std::vector<Fan> rings_;
  double ring_spacing_mm_ = 0;
  // Nothing where the shaft is not felt as force.
  std::optional<Fan> end_;
};

/// Where the spring of (15) from a colliding vertex (density above the isovalue) to a free point (density at
/// or below it) meets the surface, if the density ran linearly between the two: a share in (0, 1] of the way
/// from the vertex. Safe in the haptic tick.
double interpolated_share(double vertex_density, double free_density, double isovalue);

/// a_i of (15): from `vertex_W`, in bone, towards `free_W`, outside it, as far as the surface, which is taken
/// where the density between them would cross the isovalue. Zero where the vertex is not in bone. Safe in the
/// haptic tick.
Vec3 interpolated_spring(const Volume& volume, const Vec3& vertex_W, const Vec3& free_W);

/// The same as far as the first bone that is met on the way from `free_W` to `vertex_W`, of which the first
/// `known_free_mm` are known to be free; the whole way where `free_W` is itself in bone. Safe in the haptic
/// tick.
Vec3 marched_spring(const Volume& volume, const Vec3& vertex_W, const Vec3& free_W, double known_free_mm = 0);

}  // namespace osteomill::surface_points
