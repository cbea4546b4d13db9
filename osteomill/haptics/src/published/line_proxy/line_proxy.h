#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "osteomill/haptics/algorithm_description.h"
#include "osteomill/haptics/haptic_algorithm.h"

namespace osteomill::line_proxy {

/// Settings of algorithm 1; line_proxy_description.cpp gives their meaning, ranges and defaults.
struct Settings {
  int vertices = 51;
  double stiffness_N_per_mm = 5;
};

/// Algorithm 1 of Eriksson 2012 (section 4): the tool is its centreline, a row of vertices. If the tip's
/// vertex is in bone, a point proxy stays on the surface and a spring pulls the hand towards it. If the
/// shaft, translated to that proxy, is in bone, an intersection point (IP) stays on the surface and rotates
/// the hand about the tip. Threads and real time as in HapticAlgorithm.
///
/// Chosen where the paper is silent:
/// - normals come from the sum of eight smoothed gradients (point_proxy.h);
/// - tip and shaft keep their contacts separately, and the tip's vertex is excluded from the shaft's;
/// - the walk starts from the previous pose, translated to the proxy;
/// - there is no friction.
class LineProxy final : public HapticAlgorithm {
 public:
  /// Takes settings within their ranges.
  explicit LineProxy(const Settings& settings) : settings_(settings) {}

  std::vector<std::string> setting_warnings(const MillingTool& tool, const GridGeometry& scan) const override;
  void prepare(const AlgorithmInputs& inputs) override;
  HapticStep step(const Pose& X_WD, double dt_s) noexcept override;
  /// Does nothing: every step reads the volume itself.
  void volume_changed(const VolumeChange&) noexcept override {}
  void reset() noexcept override { state_ = ContactState{}; }
  int sample_point_count() const override { return static_cast<int>(vertices_T_.size()); }

 private:
  // State carried from one tick to the next.
  struct ContactState {
    std::optional<Vec3> device_tip_W;
    std::optional<Vec3> tip_proxy_W;
    // The centreline's pose, translated to the tip's proxy if there is one.
    std::optional<Pose> X_WL;
    std::optional<Vec3> intersection_W;
    Vec3 arm_W = Vec3::Zero();
    Vec3 reaction_N = Vec3::Zero();
  };

  std::span<const Vec3> shaft_vertices() const { return std::span(vertices_T_).subspan(1); }
  void update_tip_proxy(const Vec3& tip_W);
  std::optional<Vec3> first_tip_proxy(const Vec3& tip_W) const;
  void update_intersection(const Pose& X_WL);
  std::optional<Vec3> first_intersection(const Pose& X_WL) const;
  std::optional<Vec3> next_intersection(const Pose& X_WL) const;
  void update_reaction(const Pose& X_WL);
  void reset_if_not_finite();
  Pose drawn_tool(const Pose& X_WL) const;

  Settings settings_;
  AlgorithmInputs inputs_;
  std::vector<Vec3> vertices_T_;
  ContactState state_;
};

/// Describes algorithm 1 of the paper (section 4).
AlgorithmDescription description();

}  // namespace osteomill::line_proxy
