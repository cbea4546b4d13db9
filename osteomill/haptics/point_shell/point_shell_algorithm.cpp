#include "osteomill/haptics/point_shell/point_shell_algorithm.h"

#include <algorithm>
#include <stdexcept>

#include "osteomill/haptics/point_shell/brick_contacts.h"
#include "osteomill/haptics/point_shell/octree_contacts.h"
#include "osteomill/tool/sample_points.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::point_shell {

namespace {

// What a tick may release by its length; a longer one (a machine that stood still) counts as this long.
constexpr double kMaxTick_s = 5e-3;
// In which a stretch that nothing holds any more falls to a third, if not sooner.
constexpr double kReleaseTime_s = 0.1;
// Of the turn by which a move of the device would be made at the tool's far end.
constexpr double kTurnByMove = 0.25;
// Of the centreline, looked at for bone.
constexpr int kCentrelinePoints = 51;

// The burr's force on the bone after a move, by the derivatives from before it. A contact only pushes: where
// the move is predicted to end in a pull, the burr has left.
Vec3 burr_force_after(const ContactSum& burr, const ToolMove& move) {
  const Vec3 force = burr.force_N - burr.K_ff * move.translation_mm - burr.K_ft * move.rotation_rad;
  return force.dot(burr.force_N) > 0 ? Vec3(-force) : Vec3(Vec3::Zero());
}

bool is_at(const Pose& a, const Pose& b) {
  return a.position_mm == b.position_mm && a.orientation.coeffs() == b.orientation.coeffs();
}

}  // namespace

PointShellAlgorithm::PointShellAlgorithm(const Settings& settings)
    : settings_(settings),
      coupling_{settings.translational_stiffness_N_per_mm, settings.torsional_stiffness_Nmm_per_rad} {
  require_valid(settings);
}

void PointShellAlgorithm::prepare(const Scene& scene) {
  if (scene.volume == nullptr) throw std::invalid_argument("point-shell: the scene has no volume");
  require_valid(scene.tool);
  volume_ = scene.volume;
  centreline_T_ = centreline_vertices(scene.tool, kCentrelinePoints);
  penalty_.stiffness_N_per_mm3 = contact_stiffness_N_per_mm3(settings_, scene.tool);
  shell_ = PointShell(*scene.volume, settings_.shell);
  // Seen from a corner the surface in a cell is at most about twice a cell's side.
  penalty_.max_patch_mm2 = settings_.patch_penalty ? 2 * shell_.lattice().cell_area_mm2() : 0;
  if (settings_.closed_form_distance) {
    tool_ = ToolSignedDistance(scene.tool);
  } else {
    const double spacing_mm =
        settings_.field_spacing_mm.value_or(SampledDistanceField::suitable_spacing_mm(scene.tool));
    tool_ = ToolSignedDistance(scene.tool, SampledDistanceField(scene.tool, spacing_mm, penalty_.reach_mm()));
  }
  reset();
}

void PointShellAlgorithm::reset() {
  has_pose_ = false;
  in_contact_ = false;
  held_back_ = false;
  inside_bone_ = false;
  stretch_ = {};
}

void PointShellAlgorithm::volume_changed(const VolumeChange& change) {
  shell_.refresh(change.voxels);
  refreshed_this_tick_ = true;
}

ToolContacts PointShellAlgorithm::contacts_at(const Pose& X_WT) const {
  if (settings_.brick_kernel) return contacts_by_bricks(shell_, tool_.tool(), X_WT, penalty_);
  return contacts_by_octree(shell_, tool_, X_WT, penalty_);
}

// The target itself, to the last bit, where the tick's limits let the tool reach it.
Pose PointShellAlgorithm::towards(const Pose& X_WT_start, const Pose& target) const {
  const ToolMove wanted = move_between(X_WT_start, target);
  const ToolMove allowed = limited(wanted, settings_.max_move_mm, settings_.max_turn_rad);
  if (allowed.translation_mm == wanted.translation_mm && allowed.rotation_rad == wanted.rotation_rad) {
    return target;
  }
  return moved(X_WT_start, allowed);
}

// Short of the target where the coupling would let go faster than it may.
Pose PointShellAlgorithm::released(const Pose& X_WT_start, const Pose& target, const Pose& X_WD,
                                   double dt_s) const {
  if (!held_back_ || !(settings_.max_release_mm_s > 0) || !(settings_.max_release_rad_s > 0)) {
    return target;
  }
  const double tick_s = std::clamp(dt_s, 0.0, kMaxTick_s);
  const ToolMove device = move_between(X_WD_before_, X_WD);
  const double moved_mm = device.translation_mm.norm(), turned_rad = device.rotation_rad.norm();
  // A turn of the device may move the tool by what it moves the tool's far end, and a move turn it by a part
  // of that: held up in its turn alone, a tool that leaves the bone would be dragged behind.
  const double length_mm = std::max(tool_.tool().shaft_length_mm, tool_.tool().burr_radius_mm);
  const ToolMove stretch = move_between(X_WD, X_WT_start);
  const double fading = tick_s / kReleaseTime_s;
  const double share =
      share_released(X_WT_start, target, X_WD,
                     moved_mm + turned_rad * length_mm + fading * stretch.translation_mm.norm() +
                         settings_.max_release_mm_s * tick_s,
                     turned_rad + kTurnByMove * moved_mm / length_mm + fading * stretch.rotation_rad.norm() +
                         settings_.max_release_rad_s * tick_s);
  if (share >= 1) return target;
  const ToolMove whole = move_between(X_WT_start, target);
  return moved(X_WT_start, {share * whole.translation_mm, share * whole.rotation_rad});
}

bool PointShellAlgorithm::is_inside_bone(const Pose& X_WT) const {
  return std::any_of(centreline_T_.begin(), centreline_T_.end(), [&](const Vec3& point_T) {
    return density_at(volume_->grid(), X_WT * point_T) > volume_->isovalue();
  });
}

// Inside bone: with the device, and nothing felt.
HapticStep PointShellAlgorithm::carried(const Pose& X_WD) {
  X_WT_ = towards(X_WT_, X_WD);
  in_contact_ = false;
  held_back_ = false;
  stretch_ = {};
  HapticStep result;
  result.X_WT = X_WT_;
  return result;
}

HapticStep PointShellAlgorithm::step(const Pose& X_WD, double dt_s) {
  if (!refreshed_this_tick_ && !shell_.is_up_to_date()) shell_.refresh({});
  refreshed_this_tick_ = false;
  const bool may_be_inside = !has_pose_ || in_contact_ || inside_bone_;
  if (!has_pose_) X_WT_ = X_WD_before_ = X_WD;
  has_pose_ = true;
  inside_bone_ = settings_.carry_out_of_bone && may_be_inside && is_inside_bone(X_WT_);
  const HapticStep result = inside_bone_ ? carried(X_WD) : balanced(X_WD, dt_s);
  X_WD_before_ = X_WD;
  return result;
}

HapticStep PointShellAlgorithm::balanced(const Pose& X_WD, double dt_s) {
  const Pose start = X_WT_;
  if (settings_.look_ahead && !in_contact_) X_WT_ = released(start, towards(start, X_WD), X_WD, dt_s);

  HapticStep result;
  ToolContacts contacts;
  for (int n = 0; n < settings_.solver_iterations; ++n) {
    contacts = contacts_at(X_WT_);
    const Pose before = X_WT_;
    if (contacts.touching == 0) {
      X_WT_ = towards(start, X_WD);
    } else {
      const ToolMove move = balancing_move(coupling_, X_WT_, X_WD, contacts.total());
      X_WT_ = towards(start, moved(X_WT_, move));
    }
    X_WT_ = released(start, X_WT_, X_WD, dt_s);
    const ToolMove step_move = move_between(before, X_WT_);
    result.burr_force_W_N = burr_force_after(contacts.burr, step_move);
    if (step_move.translation_mm.norm() <= settings_.solver_tolerance_mm &&
        step_move.rotation_rad.norm() <= settings_.solver_tolerance_rad) {
      break;
    }
  }
  in_contact_ = contacts.touching > 0;
  held_back_ = in_contact_ || (held_back_ && !is_at(X_WT_, X_WD));
  result.X_WT = X_WT_;
  result.contacts = contacts.touching;
  if (held_back_) {
    result.wrench = wrench_on_hand(coupling_, X_WT_, X_WD);
    const Wrench damped = damping(X_WD, dt_s);
    result.wrench.force_N += damped.force_N;
    result.wrench.torque_Nmm += damped.torque_Nmm;
  }
  stretch_ = held_back_ ? move_between(X_WD, X_WT_) : ToolMove{};
  return result;
}

// On the speed at which the coupling's stretch changes.
Wrench PointShellAlgorithm::damping(const Pose& X_WD, double dt_s) const {
  if (!(dt_s > 0)) return {};
  const ToolMove stretch = move_between(X_WD, X_WT_);
  return {
      settings_.translational_damping_Ns_per_mm / dt_s * (stretch.translation_mm - stretch_.translation_mm),
      settings_.torsional_damping_Nmms_per_rad / dt_s * (stretch.rotation_rad - stretch_.rotation_rad)};
}

}  // namespace osteomill::point_shell
