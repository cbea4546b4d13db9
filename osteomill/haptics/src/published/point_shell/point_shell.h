#pragma once

#include <optional>
#include <string>
#include <vector>

#include "osteomill/haptics/algorithm_description.h"
#include "osteomill/haptics/haptic_algorithm.h"

#include "published/point_shell/contacts.h"
#include "published/point_shell/virtual_coupling.h"
#include "published/point_shell/voxel_shell.h"

namespace osteomill::point_shell {

/// Settings of algorithm 3; point_shell_description.cpp gives their meaning, ranges and defaults.
struct Settings {
  /// Width of the shell's voxels, whose centres are the points, in voxels of the scan.
  int scale = 3;
  double translational_stiffness_N_per_mm = 5;
  double torsional_stiffness_Nmm_per_rad = 2500;
  double damping_time_s = 0.001;
};

/// Returns kA, N per mm of depth and mm^2 of surface: 1.5 times the smallest value at which 20 N, the default
/// force limit of a device, do not push the burr through a plane.
double contact_stiffness_N_per_mm3(const MillingTool& tool);

/// Algorithm 3 of Eriksson 2012 (section 6), modified Barbic and James 2008: the bone is a shell of points,
/// the tool a signed distance field. Points inside the tool push it out, a virtual coupling pulls it to the
/// device, and each step solves for the pose at which the two balance. The hand feels the coupling's wrench.
/// Without contact the tool is exactly at the device and the wrench exactly zero.
///
/// `X_WT` of a step is the simulated tool; `burr_force_W_N` is the contact force of the points below the
/// height at which the shaft emerges from the burr's sphere; `contacts` counts the points in contact.
///
/// Chosen where the paper is silent:
/// - a point pushes along the outward normal of the tool's field;
/// - kA follows from `contact_stiffness_N_per_mm3`;
/// - each damper of the coupling is its spring times one common time constant.
class PointShell final : public HapticAlgorithm {
 public:
  /// Takes settings within their ranges.
  explicit PointShell(const Settings& settings) : settings_(settings) {}

  std::vector<std::string> setting_warnings(const MillingTool& tool, const GridGeometry& scan) const override;
  void prepare(const AlgorithmInputs& inputs) override;
  HapticStep step(const Pose& X_WD, double dt_s) noexcept override;
  void volume_changed(const VolumeChange& change) noexcept override { shell_.refresh(change.voxels); }
  void reset() noexcept override;
  int sample_point_count() const override { return static_cast<int>(shell_.points().total()); }

 private:
  Settings settings_;
  VirtualCoupling coupling_{};
  MillingTool milling_tool_;
  std::optional<SampledDistanceField> tool_;
  VoxelShell shell_;
  double stiffness_N_per_mm3_ = 0;
  // Empty before the first step.
  std::optional<Pose> X_WT_;
  ToolMove stretch_before_;
};

/// Describes algorithm 3 of the paper (section 6).
AlgorithmDescription description();

}  // namespace osteomill::point_shell
