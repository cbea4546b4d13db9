#pragma once

#include <optional>
#include <span>
#include <vector>

#include "osteomill/haptics/algorithm_description.h"
#include "osteomill/haptics/haptic_algorithm.h"
#include "osteomill/haptics/line_proxy/bone_surface.h"
#include "osteomill/haptics/line_proxy/held_line.h"
#include "osteomill/tool/burr_presses.h"

namespace osteomill::line_proxy {

/// What algorithm 1 is made of; line_proxy_description.cpp says of each setting what it means, its range and
/// its value in either mode.
struct Settings {
  int vertices = 0;
  double stiffness_N_per_mm = 0;
  double friction = 0;
  bool smoothed_normals = false;
  bool hold_line = false;
  double turning_Nmm_per_rad = 0;
  bool show_outside = false;

  /// `paper` as printed, or `steady` with every improvement at the value that was found best.
  static Settings defaults(Mode mode);
};

/// Algorithm 1 of Eriksson 2012: the tool is its centreline, a row of vertices. Where the tip's vertex is in
/// bone a point proxy stays on the surface and a spring pulls the hand to it; where the shaft, laid at that
/// proxy, is in bone an intersection point (IP) stays on the surface and turns the hand about the tip. Tip
/// and shaft remember their contacts separately. With `hold-line` both are one: the line that bone holds out
/// (`HeldLine`). Threads and real time: as HapticAlgorithm.
class LineProxy final : public HapticAlgorithm {
 public:
  /// Settings within their ranges.
  explicit LineProxy(const Settings& settings);

  void prepare(const Scene& scene) override;
  HapticStep step(const Pose& X_WD, double dt_s) override;
  /// Nothing to do: every step reads the volume itself.
  void volume_changed(const VolumeChange&) override {}
  void reset() override;
  int sample_point_count() const override { return static_cast<int>(vertices_T_.size()); }

  /// For tests: the intersection point in W, where there is one; each step's result says it too.
  const std::optional<Vec3>& intersection_W() const { return memory_.intersection_W; }

 private:
  // What one tick leaves to the next.
  struct Memory {
    std::optional<Vec3> device_before_W;
    std::optional<Vec3> device_tip_W;
    std::optional<Vec3> tip_proxy_W;
    // The centreline, laid at the tip's proxy where there is one.
    std::optional<Pose> X_WL;
    std::optional<Vec3> intersection_W;
    Vec3 arm_W = Vec3::Zero();
    Vec3 reaction_N = Vec3::Zero();
    // How far the simulated tool is kept from where the centreline would have it.
    Vec3 clearance_W = Vec3::Zero();
    // From the device to the simulated tool.
    ToolMove tool;
    PressingBurr burr;
  };

  std::span<const Vec3> shaft_vertices() const { return std::span(vertices_T_).subspan(1); }
  void follow_as_printed(const Pose& X_WD, HapticStep& result);
  void follow_with_line(const Pose& X_WD, double dt_s, HapticStep& result);
  void follow_with_tip_proxy(const Vec3& tip_W);
  std::optional<Vec3> first_tip_proxy(const Vec3& tip_W) const;
  void follow_with_intersection(const Pose& X_WL);
  std::optional<Vec3> first_intersection(const Pose& X_WL) const;
  std::optional<Vec3> next_intersection(const Pose& X_WL) const;
  void turn_reaction(const Pose& X_WL);
  double drawn_share(double arm_mm) const;
  Pose touching_tool(const Pose& X_WD, const Vec3& tool_tip_W) const;
  void keep_outside(Pose& X_WT, double dt_s);
  Pose gliding_tool(const Pose& X_WD, const Pose& touching, double dt_s);
  void forget_what_is_not_finite();

  Settings settings_;
  Scene scene_;
  NormalRule normal_;
  double turning_Nmm_per_rad_ = 0;
  HeldLine held_line_;
  std::vector<Vec3> vertices_T_;
  Memory memory_;
};

/// Algorithm 1 of the paper (section 4).
AlgorithmDescription description();

}  // namespace osteomill::line_proxy
