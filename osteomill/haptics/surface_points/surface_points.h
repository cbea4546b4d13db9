#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "osteomill/haptics/algorithm_description.h"
#include "osteomill/haptics/haptic_algorithm.h"
#include "osteomill/haptics/tool_move.h"

namespace osteomill::surface_points {

/// How far a vertex in bone is pulled towards its centre, a_i of (15): by a fraction that is measured from
/// the centre, as printed; to where linear densities would cross the isovalue; to where a walk from the
/// centre first meets bone, which sees thin walls too.
enum class Reach : unsigned char { as_printed, to_surface, to_first_bone };

/// What algorithm 2 is made of; surface_points_description.cpp says of each setting what it means, its range
/// and its value in either mode.
struct Settings {
  double stiffness_N_per_mm = 0;
  int slices = 0;
  int sphere_vertices = 0;
  int circle_vertices = 0;
  Reach reach = Reach::to_surface;
  bool hold_tool = false;
  bool shaft_force = false;
  double max_stiffness_N_per_mm = 0;

  static Settings defaults(Mode mode);
};

/// Algorithm 2 of Eriksson 2012: vertices on the tool's surface, each that is in bone a spring back to the
/// surface; the springs' forces and torques go straight to the hand (direct rendering, equations 14 to 21).
///
/// As the paper has it, a sphere or slice whose centre is in bone sends the force of the step before, so the
/// force has an upper limit beyond which the tool falls through, and nothing is held where the first contact
/// is already that deep; a contact of the shaft alone sends a torque and no force. What `steady` does instead
/// is said at each setting in surface_points_description.cpp.
class SurfacePoints final : public HapticAlgorithm {
 public:
  /// Settings within their ranges.
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
    // The force of this step; as printed, where the centre is in bone, of the last step when it was not:
    // (17), (19). `contacts` is always of this step.
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

/// Algorithm 2 of the paper (section 5).
AlgorithmDescription description();

}  // namespace osteomill::surface_points
