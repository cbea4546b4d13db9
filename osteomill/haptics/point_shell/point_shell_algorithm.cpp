#include "osteomill/haptics/point_shell/point_shell_algorithm.h"

#include <stdexcept>

#include "osteomill/haptics/point_shell/brick_contacts.h"
#include "osteomill/haptics/point_shell/octree_contacts.h"

namespace osteomill {

namespace {

// The burr's force after a move, by the derivatives from before it. A contact only pushes: where the move is
// predicted to end in a pull, the burr has left.
double burr_force_after(const ContactSum& burr, const ToolMove& move) {
  const Vec3 force = burr.force_N - burr.K_ff * move.translation_mm - burr.K_ft * move.rotation_rad;
  return force.dot(burr.force_N) > 0 ? force.norm() : 0.0;
}

}  // namespace

PointShellAlgorithm::PointShellAlgorithm(const PointShellSettings& settings)
    : settings_(settings),
      coupling_{settings.translational_stiffness_N_per_mm, settings.torsional_stiffness_Nmm_per_rad} {
  require_valid(settings);
}

void PointShellAlgorithm::prepare(const Scene& scene) {
  if (scene.volume == nullptr) throw std::invalid_argument("point-shell: the scene has no volume");
  require_valid(scene.tool);
  penalty_.stiffness_N_per_mm3 = contact_stiffness_N_per_mm3(settings_, scene.tool);
  shell_ = PointShell(*scene.volume, settings_.shell);
  // Seen from a corner the surface in a cell is at most about twice a cell's side.
  penalty_.greatest_patch_mm2 = settings_.patch_penalty ? 2 * shell_.lattice().cell_area_mm2() : 0;
  if (settings_.closed_form_distance) {
    tool_ = ContactTool(scene.tool);
  } else {
    const double spacing_mm =
        settings_.field_spacing_mm.value_or(SampledDistanceField::suitable_spacing_mm(scene.tool));
    tool_ = ContactTool(scene.tool, SampledDistanceField(scene.tool, spacing_mm, penalty_.reach_mm()));
  }
  reset();
}

void PointShellAlgorithm::reset() {
  has_pose_ = false;
  in_contact_ = false;
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
  const ToolMove allowed = limited(wanted, settings_.greatest_move_mm, settings_.greatest_turn_rad);
  if (allowed.translation_mm == wanted.translation_mm && allowed.rotation_rad == wanted.rotation_rad) {
    return target;
  }
  return moved(X_WT_start, allowed);
}

HapticStep PointShellAlgorithm::step(const Pose& X_WD, double dt_s) {
  if (!refreshed_this_tick_ && !shell_.is_up_to_date()) shell_.refresh({});
  refreshed_this_tick_ = false;
  if (!has_pose_) X_WT_ = X_WD;
  has_pose_ = true;
  const Pose start = X_WT_;
  if (settings_.look_ahead && !in_contact_) X_WT_ = towards(start, X_WD);

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
    const ToolMove step_move = move_between(before, X_WT_);
    result.burr_force_N = burr_force_after(contacts.burr, step_move);
    if (step_move.translation_mm.norm() <= settings_.solver_tolerance_mm &&
        step_move.rotation_rad.norm() <= settings_.solver_tolerance_rad) {
      break;
    }
  }
  in_contact_ = contacts.touching > 0;
  result.X_WT = X_WT_;
  result.contacts = contacts.touching;
  if (in_contact_) {
    result.wrench = wrench_on_hand(coupling_, X_WT_, X_WD);
    const Wrench damped = damping(X_WD, dt_s);
    result.wrench.force_N += damped.force_N;
    result.wrench.torque_Nmm += damped.torque_Nmm;
  }
  stretch_ = in_contact_ ? move_between(X_WD, X_WT_) : ToolMove{};
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

}  // namespace osteomill
