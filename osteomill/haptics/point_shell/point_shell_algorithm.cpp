#include "osteomill/haptics/point_shell/point_shell_algorithm.h"

#include <cmath>
#include <stdexcept>

#include "osteomill/tool/sample_points.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::point_shell {

namespace {

constexpr std::size_t kNearPoints = 65536;
// Newton steps a tick; the second only where the first moved the tool by more than this.
constexpr int kSteps = 2;
constexpr double kSettled_mm = 0.005;
constexpr double kSettled_rad = 0.0005;
// The most that the tool moves in a tick: further, it could leap past thin walls.
const MoveBound kMost{{}, 0.5, 0.05};
// Of the centreline, looked at for bone.
constexpr int kCentrelinePoints = 51;

// The burr's force on the bone after a move, by the derivatives from before it. A contact only pushes: where
// the move is predicted to end in a pull, the burr has left.
Vec3 burr_force_after(const EnergySum& burr, const ToolMove& move) {
  const Vec3 before = -burr.gradient.head<3>();
  const Vec3 force = before - burr.convex.topLeftCorner<3, 3>() * move.translation_mm -
                     burr.convex.topRightCorner<3, 3>() * move.rotation_rad;
  return force.dot(before) > 0 ? Vec3(-force) : Vec3(Vec3::Zero());
}

}  // namespace

PointShellAlgorithm::PointShellAlgorithm(const Settings& settings)
    : settings_(settings),
      coupling_{settings.translational_stiffness_N_per_mm, settings.torsional_stiffness_Nmm_per_rad, 0} {}

void PointShellAlgorithm::prepare(const Scene& scene) {
  if (scene.volume == nullptr) throw std::invalid_argument("point-shell: the scene has no volume");
  require_valid(scene.tool);
  volume_ = scene.volume;
  milling_tool_ = scene.tool;
  coupling_.damping_ticks = settings_.damping_time_s / scene.tick_period_s;
  centreline_T_ = centreline_vertices(scene.tool, kCentrelinePoints);
  penalty_.stiffness_N_per_mm3 = contact_stiffness_N_per_mm3(settings_, scene.tool);
  if (settings_.surface_shell) {
    surface_ = BoneBricks(*scene.volume, settings_.scale * BoneBricks::kSpacing_mm, BoneBricks::Points::fine);
    near_ = NearBone(kNearPoints, NearBone::PointsMeet::the_nearest_part);
    // Seen from a corner the surface in a cell is at most about twice a cell's side.
    penalty_.max_patch_mm2 = 2 * surface_.lattice().cell_area_mm2();
  } else {
    voxels_ = VoxelShell(*scene.volume, settings_.scale);
    penalty_.max_patch_mm2 = 0;
    tool_.emplace(scene.tool, SampledDistanceField::suitable_spacing_mm(scene.tool));
  }
  reset();
}

void PointShellAlgorithm::reset() {
  has_pose_ = false;
  in_contact_ = false;
  held_back_ = false;
  carried_ = false;
  stretch_before_ = {};
}

int PointShellAlgorithm::sample_point_count() const {
  return static_cast<int>(settings_.surface_shell ? surface_.fine().total() : voxels_.points().total());
}

void PointShellAlgorithm::volume_changed(const VolumeChange& change) {
  if (settings_.surface_shell) {
    surface_.refresh(change.voxels);
  } else {
    voxels_.refresh(change.voxels);
  }
}

ToolContacts PointShellAlgorithm::contacts_at(const Pose& X_WT) {
  return settings_.surface_shell
             ? contacts_by_bricks(surface_, near_, milling_tool_, X_WT, penalty_)
             : contacts_by_octree(voxels_, milling_tool_, *tool_, X_WT, penalty_.stiffness_N_per_mm3);
}

// Short of the target, along the way there, where what is felt would leap.
Pose PointShellAlgorithm::towards(const Pose& X_WT_start, const Pose& target, const MoveBound& bound) const {
  if (!settings_.guarded_move) return target;
  const Pose near = moved_within(kMost, X_WT_start, target);
  return held_back_ ? moved_within(bound, X_WT_start, near) : near;
}

HapticStep PointShellAlgorithm::step(const Pose& X_WD, double dt_s) {
  if (settings_.surface_shell) surface_.begin_tick(milling_tool_, X_WT_);
  const bool begins = !has_pose_;
  if (begins) X_WT_ = X_WD_before_ = X_WD;
  has_pose_ = true;
  if (begins) carried_ = settings_.guarded_move && count_in_bone(*volume_, centreline_T_, X_WD) > 0;
  if (carried_) {
    carried_ = count_in_bone(*volume_, centreline_T_, X_WD) > 0 || contacts_at(X_WD).total().touching > 0 ||
               near_.is_incomplete();
  }
  HapticStep result;
  if (carried_) {
    result.X_WT = X_WT_ = X_WD;
  } else {
    result = balanced(X_WD, dt_s);
    if (settings_.surface_shell) {
      near_.find_bearing(0, surface_.bearing());
      result.owed_bricks = static_cast<int>(surface_.owed());
    }
  }
  X_WD_before_ = X_WD;
  return result;
}

HapticStep PointShellAlgorithm::balanced(const Pose& X_WD, double dt_s) {
  const Pose start = X_WT_;
  const double spring_length_mm =
      std::sqrt(settings_.torsional_stiffness_Nmm_per_rad / settings_.translational_stiffness_N_per_mm);
  const MoveBound bound = move_bound(start, X_WD_before_, X_WD, spring_length_mm, Release{}, dt_s);
  if (settings_.guarded_move && !in_contact_) X_WT_ = towards(start, X_WD, bound);

  HapticStep result;
  for (int n = 0; n < (settings_.guarded_move ? kSteps : 1); ++n) {
    const ToolContacts contacts = contacts_at(X_WT_);
    const EnergySum all = contacts.total();
    result.contacts = all.touching;
    if (near_.is_incomplete()) {
      X_WT_ = start;
      held_back_ = true;
      break;
    }
    const Pose before = X_WT_;
    Pose target = X_WD;
    if (all.touching > 0) target = moved(X_WT_, balancing_move(coupling_, X_WT_, X_WD, stretch_before_, all));
    X_WT_ = towards(start, target, bound);
    const ToolMove step_move = move_between(before, X_WT_);
    result.burr_force_W_N = burr_force_after(contacts.burr, step_move);
    if (step_move.translation_mm.norm() <= kSettled_mm && step_move.rotation_rad.norm() <= kSettled_rad) {
      break;
    }
  }
  in_contact_ = result.contacts > 0;
  held_back_ = in_contact_ || (held_back_ && X_WT_ != X_WD);
  result.X_WT = X_WT_;
  if (held_back_) result.wrench = wrench_on_hand(coupling_, X_WT_, X_WD, stretch_before_);
  stretch_before_ = move_between(X_WD, X_WT_);
  return result;
}

}  // namespace osteomill::point_shell
