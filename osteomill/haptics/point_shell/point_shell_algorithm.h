#pragma once

#include <optional>
#include <vector>

#include "osteomill/haptics/bone_points/near_bone.h"
#include "osteomill/haptics/bone_points/push_law.h"
#include "osteomill/haptics/haptic_algorithm.h"
#include "osteomill/haptics/point_shell/contacts.h"
#include "osteomill/haptics/point_shell/point_shell_description.h"
#include "osteomill/haptics/point_shell/virtual_coupling.h"
#include "osteomill/haptics/point_shell/voxel_shell.h"

namespace osteomill::point_shell {

/// Algorithm 3 of Eriksson 2012, modified Barbic and James 2008: the bone is a shell of points, the tool a
/// signed distance field. Points inside the tool push it out; a virtual coupling pulls it to the device; each
/// step solves for the pose at which the two balance, and the coupling's wrench is what the hand feels.
/// Without contact the tool is at the device (steady: on its way there) and the wrench exactly zero; steady
/// lets what was felt fade first.
///
/// `X_WT` of a step is the simulated tool; `burr_force_W_N` the contact force of the points that touch the
/// burr (paper: the tool below the height at which its shaft comes out of the burr's sphere); `contacts`
/// counts the points that touch.
class PointShellAlgorithm final : public HapticAlgorithm {
 public:
  /// Settings within their ranges.
  explicit PointShellAlgorithm(const Settings& settings);

  void prepare(const Scene& scene) override;
  HapticStep step(const Pose& X_WD, double dt_s) override;
  void volume_changed(const VolumeChange& change) override;
  void reset() override;
  int sample_point_count() const override;

  const Penalty& penalty() const { return penalty_; }

 private:
  ToolContacts contacts_at(const Pose& X_WT);
  Pose towards(const Pose& X_WT_start, const Pose& target, const MoveBound& bound) const;
  HapticStep balanced(const Pose& X_WD, double dt_s);

  Settings settings_;
  VirtualCoupling coupling_;
  MillingTool milling_tool_;
  // The bone, one or the other, and what meets it.
  VoxelShell voxels_;
  std::optional<SampledDistanceField> tool_;
  BoneBricks surface_;
  NearBone near_;
  Penalty penalty_;

  bool has_pose_ = false;
  bool in_contact_ = false;
  // In contact, or on the way back to the device from it.
  bool held_back_ = false;
  // Began inside bone and has not yet been outside: with the device, and nothing is felt.
  bool carried_ = false;
  const Volume* volume_ = nullptr;
  std::vector<Vec3> centreline_T_;
  Pose X_WT_;
  Pose X_WD_before_;
  ToolMove stretch_before_;
};

}  // namespace osteomill::point_shell
