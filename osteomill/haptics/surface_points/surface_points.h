#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "osteomill/haptics/haptic_algorithm.h"
#include "osteomill/haptics/surface_points/surface_points_description.h"
#include "osteomill/haptics/tool_move.h"

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
  void volume_changed(const VolumeChange& change) override;
  void reset() override;
  int sample_point_count() const override;

 private:
  // The vertices that share a centre: the sphere, or a slice of the shaft.
  struct Fan {
    bool is_slice = false;
    Vec3 centre_T = Vec3::Zero();
    double radius_mm = 0;
    // From the centre to each vertex, and how far it is pushed back by now where the tool is held.
    std::vector<Vec3> arms_T;
    std::vector<double> depths_mm;
    // Of this step or, where the centre is in bone, of the last step when it was not: (17), (19).
    Vec3 force_W_N = Vec3::Zero();
    int contacts = 0;
  };
  // Where the vertices stand.
  struct Stand {
    Pose X_WV;
    // The tool that bone holds, and the share of its coupling that is felt beside the vertices' springs.
    HapticStep held;
    double coupled = 0;
    // How far the vertices went since the tick before, and how far their springs may give way beside that.
    ToolMove move;
    double give_mm = 0;
  };
  Stand stand(const Pose& X_WD, double dt_s);
  void update(Fan& fan, const Stand& at) const;
  Vec3 sum_of_reaches(Fan& fan, const Stand& at, const Vec3& centre_W, bool inside) const;
  Vec3 reach_of(const Vec3& vertex_W, const Vec3& centre_W, double free_mm) const;
  bool in_bone(const Vec3& point_W) const;
  Vec3 soften(const Vec3& force_N) const;
  Vec3 damping_N(double force_N, const Vec3& overlap_W_mm, double dt_s);

  Settings settings_;
  const Volume* volume_ = nullptr;
  MillingTool tool_;
  // Nothing where the tool is not held.
  std::unique_ptr<HapticAlgorithm> held_tool_;
  // How far within the held tool's surface bone may lie.
  double inset_mm_ = 0;
  std::optional<Pose> X_WV_before_;
  // From the held tool's burr to the device's, and its filtered rate.
  Vec3 last_overlap_W_mm_ = Vec3::Zero();
  Vec3 overlap_rate_W_mm_s_ = Vec3::Zero();
  Fan sphere_;
  std::vector<Fan> slices_;
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
