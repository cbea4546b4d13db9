#pragma once

#include <vector>

#include "osteomill/haptics/algorithm_description.h"
#include "osteomill/haptics/barrier_shell_counts.h"
#include "osteomill/haptics/haptic_algorithm.h"

#include "barrier_shell/coupling.h"
#include "barrier_shell/near_bone.h"
#include "barrier_shell/no_go_barriers.h"
#include "bone_points/bone_bricks.h"
#include "tool_move.h"

namespace osteomill::barrier_shell {

/// Settings of barrier-shell; its description gives their meaning, ranges and defaults.
struct Settings {
  double translational_stiffness_N_per_mm = 2;
  double torsional_stiffness_Nmm_per_rad = 1000;
  double skin_width_mm = 0.25;
  double rounding_mm = 0.212;
  double pressure_N_per_mm2 = 3;
  double point_spacing_mm = BoneBricks::kSpacing_mm;
  double release_time_s = Release{}.time_s;
  double release_mm_s = Release{}.mm_s;
  double release_rad_s = Release{}.rad_s;
};

struct NewtonStep;

/// Algorithm 4: the tool rests on a soft skin of bone that no force can push it through. A barrier that grows
/// without bound keeps two convex cores inside the tool away from the isosurface's points. Each tick takes a
/// few Newton steps on the sum of barrier and virtual coupling energy, each certified free of penetration
/// before it is taken. This is incremental potential contact (Li et al. 2020) for a tool on a changing
/// volume. Structures of the volume that have a guard add a barrier each (NoGoBarriers).
///
/// `X_WT` of a step is the simulated tool, the wrench the coupling's; `contacts` counts points in contact
/// with a core, and guards; `burr_force_W_N` is the ball's force on the bone.
class BarrierShell final : public HapticAlgorithm {
 public:
  /// Takes settings within their ranges.
  explicit BarrierShell(const Settings& settings);

  void prepare(const AlgorithmInputs& inputs) override;
  HapticStep step(const Pose& X_WD, double dt_s) noexcept override;
  void volume_changed(const VolumeChange& change) noexcept override;
  void reset() noexcept override;
  int sample_point_count() const override { return static_cast<int>(bricks_.fine().total()); }

  const Counts& counts() const { return counts_; }

 private:
  struct State;
  void begin_outside(const Pose& X_WD);
  void grow_cores(double nearest_mm, double dt_s);
  Cores cores() const;
  State evaluate(const Pose& X_WT, const Pose& X_WD);
  void gather(const Pose& X_WT, const MoveSize& leeway);
  void gather_for_next_move();
  bool check_path_clear(const Pose& X_WD, const MoveBound& bound);
  double share_with_leeway(const MoveSize& step) const;
  NewtonStep next_step(const State& best, const MoveBound& bound);
  static Pose pose_after(const State& best, const NewtonStep& step, const Pose& X_WD);
  State solve(const Pose& X_WD, double dt_s);
  void count_energy_rise(const State& state);
  HapticStep report(const State& state, const Pose& X_WD, double dt_s);

  Settings settings_;
  Coupling coupling_;
  Barrier barrier_{};
  MillingTool tool_;
  const Volume* volume_ = nullptr;
  std::vector<Vec3> centreline_T_;
  BoneBricks bricks_;
  NearBone near_;
  MeasuredBone measured_;
  NoGoBarriers no_go_barriers_;

  bool has_pose_ = false;
  Pose X_WT_;
  Pose X_WD_before_;
  // The tool's move in the last tick, which determines the next leeway.
  MoveSize last_move_;
  // Leeway of the last gathering, and the remainder.
  MoveSize leeway_;
  MoveSize leeway_left_;
  // Started inside bone and has not been outside since: follows the device without force.
  bool started_inside_bone_ = false;
  // True once all bone around the tool is known; until then the tool stands still.
  bool has_begun_ = false;
  // Remaining inset of the cores, mm, for a tool that started in contact with bone; shrinks as they grow.
  double core_inset_mm_ = 0;
  // Progress, 0 to 1, of the blend from the previously sent wrench to the computed one.
  double ramp_ = 1;
  Wrench ramp_from_;
  Wrench sent_;
  // Stored energy at the end of the last tick, valid if has_energy_.
  double energy_before_Nmm_ = 0;
  bool has_energy_ = false;
  Counts counts_;
};

/// Describes algorithm 4, which is not from the paper.
AlgorithmDescription description();

}  // namespace osteomill::barrier_shell
