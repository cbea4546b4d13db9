#include "barrier_shell/barrier_shell.h"

#include <algorithm>
#include <stdexcept>

#include <Eigen/Cholesky>

#include "osteomill/haptics/sample_points.h"
#include "osteomill/volume/sampling.h"

#include "barrier_shell/certificate.h"

namespace osteomill::barrier_shell {

struct NewtonStep {
  Vector6 move_T;
  bool is_damped = false;
  // Too small to change the energy sums evaluated after it.
  bool is_last = false;
  bool reaches_device = false;
};

namespace {

constexpr std::size_t kNearPoints = 65536;
constexpr int kCentrelinePoints = 51;

// Largest number of energy evaluations in a tick.
constexpr int kMaxPasses = 4;
// Factor by which a step is shortened if it did not lower the energy.
constexpr double kBacktrackFactor = 0.4;
// A step below both counts as converged: later sums would not change.
constexpr double kConvergedStep_mm = 2e-4;
constexpr double kConvergedStep_rad = 2e-5;
// Relative rounding error of the energy, which is summed in single precision.
constexpr double kEnergyRounding = 1e-6;
// Relative rise of the energy attributed to rounding: the last step is not evaluated, and the order of
// summation varies.
constexpr double kEnergyRiseTolerance = 1e-5;

// The leeway of a gathering is kLeewayPerMove times the last move plus kExtraLeeway, clamped to these bounds.
constexpr MoveSize kMaxLeeway{0.4, 0.03};
constexpr MoveSize kMinLeeway{0.05, 0.004};
constexpr MoveSize kExtraLeeway{0.03, 0.002};
constexpr double kLeewayPerMove = 3;
// Largest move in free space: more than the fastest hand covers in a tick.
constexpr MoveSize kMaxFreeMove{5.0, 0.3};

// For a tool that starts in contact with bone: its cores are first shrunk until the nearest point is
// kStartGapShare of the skin's width away. They then grow at up to kGrowth_mm_s while the nearest point stays
// more than kMinGapShare of the skin's width away.
constexpr double kStartGapShare = 0.2;
constexpr double kMinGapShare = 0.02;
constexpr double kGrowth_mm_s = 5;
// A device move beyond these in a tick counts as a jump, not as hand motion; the wrench is then blended over
// kRamp_s.
constexpr double kJump_mm = 1;
constexpr double kJump_rad = 0.1;
constexpr double kFastestHand_mm_s = 1000;
constexpr double kFastestHand_rad_s = 100;
constexpr double kRamp_s = 0.2;

MoveSize size_of(const ToolMove& move) {
  return {move.translation_mm.norm(), move.rotation_rad.norm()};
}

MoveSize size_of(const Vector6& move_T) {
  return {move_T.head<3>().norm(), move_T.tail<3>().norm()};
}

ToolMove in_world(const Pose& X_WT, const Vector6& move_T) {
  return {X_WT.orientation * Vec3(move_T.head<3>()), X_WT.orientation * Vec3(move_T.tail<3>())};
}

// Largest number of damping corrections, and the relative overshoot of the balls tolerated without one;
// beyond it the step is shortened.
constexpr int kDampings = 6;
constexpr double kBoundTolerance = 1.01;
// Lower bound on radii used as divisors, mm or rad: in a tick of length zero nothing is released.
constexpr double kMinRadius = 1e-9;

// A small tool has a thinner skin, in proportion to its reduced rounding, so that it is felt where it is
// drawn. A burr meets bone over about its cross-section, so pressure is scaled inversely with it: every burr
// is held where it is drawn.
Barrier scaled_barrier(const MillingTool& tool, const Settings& settings) {
  const double thinner = core_inset_mm(tool, settings.rounding_mm) / settings.rounding_mm;
  const double smaller = MillingTool{}.burr_radius_mm / tool.burr_radius_mm;
  return {thinner * settings.skin_width_mm, smaller * smaller * settings.pressure_N_per_mm2};
}

// Returns the largest point spacing that a core of this radius cannot pass through: it passes when half the
// diagonal of four points, 0.71 of the spacing, exceeds its radius. Leaves a margin of 15 %.
double max_point_spacing_mm(double core_radius_mm) {
  constexpr double kShareOfCore = 1.2;
  return kShareOfCore * core_radius_mm;
}

// Computes the Newton step; if the energy is not convex, that of a convex upper model. If the step would
// leave one of the balls in which the tool's move may end, damping in proportion to the coupling's stiffness
// C keeps it in both, so that force and torque fade together: u = so_far_T + step, with so_far_T the move
// since the tick's start minus the balls' centres, solves (H + mu C) u = H so_far_T - g, with mu adjusted
// until u is on the sphere, as in a trust-region method (More and Sorensen 1983).
NewtonStep newton_step(const EnergySum& sum, const Coupling& coupling, const Vector6& so_far_T,
                       const MoveBound& bound) {
  Matrix6 H = sum.convex + sum.rest;
  Eigen::LLT<Matrix6> factor(H);
  if (factor.info() != Eigen::Success) factor.compute(H = sum.convex);
  NewtonStep step{-factor.solve(sum.gradient)};
  Vector6 stiffness;
  stiffness << Vec3::Constant(coupling.translational_N_per_mm),
      Vec3::Constant(coupling.torsional_Nmm_per_rad);
  const Vector6 pull = H * so_far_T - sum.gradient;
  const double radii[2] = {std::max(bound.radius_mm, kMinRadius), std::max(bound.radius_rad, kMinRadius)};
  double damping = 0;
  for (int n = 0; n < kDampings; ++n) {
    const Vector6 u = so_far_T + step.move_T;
    const double over[2] = {u.head<3>().norm() / radii[0], u.tail<3>().norm() / radii[1]};
    const int worse = over[1] > over[0] ? 1 : 0;
    if (over[worse] <= kBoundTolerance) break;
    const Vector6 falling = factor.solve(stiffness.cwiseProduct(u));
    const auto part = u.segment<3>(3 * worse);
    damping +=
        (over[worse] - 1) * part.squaredNorm() / std::max(part.dot(falling.segment<3>(3 * worse)), 1e-12);
    step.is_damped = true;
    Matrix6 damped = H;
    damped.diagonal() += damping * stiffness;
    factor.compute(damped);
    step.move_T = factor.solve(pull) - so_far_T;
  }
  for (int part = 0; part < 2; ++part) {
    step.move_T *= share_within(Vec3::Zero(), kBoundTolerance * radii[part], so_far_T.segment<3>(3 * part),
                                step.move_T.segment<3>(3 * part));
  }
  return step;
}

}  // namespace

// A pose and its energy sums.
struct BarrierShell::State {
  Pose X_WT;
  EnergySum sum;
  double barrier_Nmm = 0;
  Vec3 burr_force_T = Vec3::Zero();
};

const Counts* counts_of(const HapticAlgorithm& algorithm) {
  const auto* shell = dynamic_cast<const BarrierShell*>(&algorithm);
  return shell == nullptr ? nullptr : &shell->counts();
}

BarrierShell::BarrierShell(const Settings& settings)
    : settings_(settings),
      coupling_{settings.translational_stiffness_N_per_mm, settings.torsional_stiffness_Nmm_per_rad} {}

void BarrierShell::prepare(const AlgorithmInputs& inputs) {
  if (inputs.volume == nullptr) throw std::invalid_argument("barrier-shell: there is no volume");
  require_valid(inputs.tool);
  volume_ = inputs.volume;
  tool_ = inputs.tool;
  barrier_ = scaled_barrier(inputs.tool, settings_);
  centreline_T_ = centreline_vertices(inputs.tool, kCentrelinePoints);
  core_inset_mm_ = 0;
  const Cores whole = cores();
  const double at_shaft_mm = max_point_spacing_mm(whole.cylinder_radius_mm);
  const double spacing_mm =
      std::min({settings_.point_spacing_mm, max_point_spacing_mm(whole.ball_radius_mm), at_shaft_mm});
  bricks_ = BoneBricks(*inputs.volume, spacing_mm, inputs.tick_period_s);
  near_ = NearBone(kNearPoints, 2 * spacing_mm > at_shaft_mm);
  measured_ = MeasuredBone(kNearPoints);
  no_go_barriers_ = NoGoBarriers(inputs.volume->no_go().get(), inputs.tool);
  reset();
}

void BarrierShell::reset() noexcept {
  has_pose_ = false;
  started_inside_bone_ = false;
  has_energy_ = false;
  sent_ = {};
}

void BarrierShell::volume_changed(const VolumeChange& change) noexcept {
  bricks_.refresh(change.voxels);
}

Cores BarrierShell::cores() const {
  return Cores::within(tool_, settings_.rounding_mm, core_inset_mm_);
}

// Starts with cores inset so far that no point is inside them. Called every tick until all bone around the
// tool is known.
void BarrierShell::begin_outside(const Pose& X_WD) {
  last_move_ = {};
  core_inset_mm_ = 0;
  ramp_ = 0;
  ramp_from_ = {};
  has_energy_ = false;
  no_go_barriers_.begin_at(X_WT_.position_mm);
  if (started_inside_bone_) return;
  gather(X_WT_, {});
  has_begun_ = !near_.is_incomplete();
  near_.measure(cores(), barrier_, X_WT_, measured_);
  const EnergySum &ball = measured_.ball.sum, &cylinder = measured_.cylinder.sum;
  const double nearest_mm = std::min(ball.nearest_mm, cylinder.nearest_mm);
  core_inset_mm_ = std::max(0.0, kStartGapShare * barrier_.width_mm - nearest_mm);
  if (ball.touching + cylinder.touching == 0 && X_WT_ == X_WD &&
      no_go_barriers_.is_clear(X_WT_.position_mm, 0))
    ramp_ = 1;
}

void BarrierShell::grow_cores(double nearest_mm, double dt_s) {
  if (core_inset_mm_ == 0) return;
  // Limited by the free gap: in a hole too narrow for the tool the cores stay small.
  const double room_mm = 0.2 * (nearest_mm - kMinGapShare * barrier_.width_mm);
  const double growth = std::clamp(room_mm, 0.0, kGrowth_mm_s * std::max(0.0, dt_s));
  core_inset_mm_ = std::max(0.0, core_inset_mm_ - growth);
  has_energy_ = false;
}

void BarrierShell::gather(const Pose& X_WT, const MoveSize& leeway) {
  leeway_ = leeway_left_ = leeway;
  near_.gather(bricks_, cores(), barrier_.width_mm, X_WT, leeway);
}

BarrierShell::State BarrierShell::evaluate(const Pose& X_WT, const Pose& X_WD) {
  near_.measure(cores(), barrier_, X_WT, measured_);
  const EnergySum &ball = measured_.ball.sum, &cylinder = measured_.cylinder.sum;
  State state{X_WT, coupling_.sum(X_WT, X_WD), ball.energy_Nmm + cylinder.energy_Nmm,
              ball.gradient.head<3>()};
  state.sum += ball;
  state.sum += cylinder;
  if (!no_go_barriers_.empty()) state.barrier_Nmm += no_go_barriers_.add_to(state.sum, X_WT);
  ++counts_.passes;
  counts_.max_points = std::max<std::uint64_t>(counts_.max_points, near_.point_count());
  return state;
}

// Counts a rise of the stored energy since the last tick, both at the previous device pose.
void BarrierShell::count_energy_rise(const State& state) {
  if (!has_energy_) return;
  const double now_Nmm = state.barrier_Nmm + coupling_.energy_Nmm(state.X_WT, X_WD_before_);
  const double rise_Nmm = now_Nmm - energy_before_Nmm_;
  if (rise_Nmm <= kEnergyRiseTolerance * (1 + energy_before_Nmm_)) return;
  ++counts_.energy_rises;
  counts_.energy_risen_Nmm += rise_Nmm;
  counts_.worst_rise_Nmm = std::max(counts_.worst_rise_Nmm, rise_Nmm);
}

// Returns true if no points are gathered, the move is within the bound, and the path is clear.
bool BarrierShell::check_path_clear(const Pose& X_WD, const MoveBound& bound) {
  const ToolMove move = move_between(X_WT_, X_WD);
  const MoveSize move_size = size_of(move);
  return near_.is_empty() && share_within(bound, move) >= 1 && move_size.move_mm <= kMaxFreeMove.move_mm &&
         move_size.turn_rad <= kMaxFreeMove.turn_rad &&
         no_go_barriers_.is_clear(X_WT_.position_mm, move_size.move_mm) &&
         check_clearance(bricks_, cores(), barrier_.width_mm, X_WT_, move_size);
}

void BarrierShell::gather_for_next_move() {
  const auto reach = [](double last, double spare, double min, double max) {
    return std::clamp(kLeewayPerMove * last + spare, min, max);
  };
  gather(X_WT_,
         {reach(last_move_.move_mm, kExtraLeeway.move_mm, kMinLeeway.move_mm, kMaxLeeway.move_mm),
          reach(last_move_.turn_rad, kExtraLeeway.turn_rad, kMinLeeway.turn_rad, kMaxLeeway.turn_rad)});
}

// Returns the share of a step that the remaining leeway covers.
double BarrierShell::share_with_leeway(const MoveSize& step) const {
  const double move = step.move_mm > leeway_left_.move_mm ? leeway_left_.move_mm / step.move_mm : 1;
  const double turn = step.turn_rad > leeway_left_.turn_rad ? leeway_left_.turn_rad / step.turn_rad : 1;
  return std::max(0.0, std::min(move, turn));
}

// Returns the Newton step, limited to the share that is certified and may be released.
NewtonStep BarrierShell::next_step(const State& best, const MoveBound& bound) {
  const ToolMove so_far = move_between(X_WT_, best.X_WT);
  const Vec3 moved = so_far.translation_mm - bound.middle.translation_mm;
  const Vec3 turned = so_far.rotation_rad - bound.middle.rotation_rad;
  const Quat to_T = best.X_WT.orientation.conjugate();
  Vector6 so_far_T;
  so_far_T << to_T * moved, to_T * turned;
  NewtonStep step = newton_step(best.sum, coupling_, so_far_T, bound);
  const MoveSize step_size = size_of(step.move_T);
  step.is_last = step_size.move_mm <= kConvergedStep_mm && step_size.turn_rad <= kConvergedStep_rad;
  // No evaluation follows, so a last step that would raise the energy is dropped: slight overdamping may pull
  // it back from a ball's surface.
  const Vector6 slope = best.sum.gradient + 0.5 * (best.sum.convex + best.sum.rest) * step.move_T;
  if (step.is_last && slope.dot(step.move_T) > 0) step.move_T.setZero();
  if (!step.is_last && share_with_leeway(step_size) < 1 && leeway_.move_mm < kMaxLeeway.move_mm) {
    gather(best.X_WT, kMaxLeeway);
    near_.measure(cores(), barrier_, best.X_WT, measured_);
  }
  if (near_.is_incomplete()) return {.move_T = Vector6::Zero(), .is_last = true};
  const double within_leeway = share_with_leeway(step_size);
  step.move_T *= within_leeway;
  double certified = certified_fraction(measured_.max_use(step.move_T, barrier_));
  step.move_T *= certified;
  if (!no_go_barriers_.empty()) {
    const Vec3 move_W_mm = best.X_WT.orientation * Vec3(step.move_T.head<3>());
    const double kept = no_go_barriers_.safe_step_fraction(best.X_WT.position_mm, move_W_mm);
    step.move_T *= kept;
    certified *= kept;
  }
  step.reaches_device = best.sum.touching == 0 && !step.is_damped && within_leeway >= 1 && certified >= 1;
  return step;
}

Pose BarrierShell::pose_after(const State& best, const NewtonStep& step, const Pose& X_WD) {
  return step.reaches_device ? X_WD : moved(best.X_WT, in_world(best.X_WT, step.move_T));
}

BarrierShell::State BarrierShell::solve(const Pose& X_WD, double dt_s) {
  const Pose start = X_WT_;
  const MoveBound bound =
      move_bound(start, X_WD_before_, X_WD, coupling_.length_mm(),
                 {settings_.release_time_s, settings_.release_mm_s, settings_.release_rad_s}, dt_s);
  gather_for_next_move();
  if (check_path_clear(X_WD, bound)) return {X_WD};
  State best = evaluate(start, X_WD);
  count_energy_rise(best);
  counts_.min_distance_share = std::min(counts_.min_distance_share, best.sum.nearest_mm / barrier_.width_mm);
  for (int passes = 1;;) {
    NewtonStep step = next_step(best, bound);
    if (step.is_last) {
      best.X_WT = pose_after(best, step, X_WD);
      return best;
    }
    bool taken = false;
    while (!taken && passes < kMaxPasses) {
      const State trial = evaluate(pose_after(best, step, X_WD), X_WD);
      ++passes;
      taken = trial.sum.energy_Nmm <= best.sum.energy_Nmm * (1 + kEnergyRounding);
      if (taken) {
        leeway_left_.move_mm -= step.move_T.head<3>().norm();
        leeway_left_.turn_rad -= step.move_T.tail<3>().norm();
        best = trial;
      } else {
        step.move_T *= kBacktrackFactor;
        step.reaches_device = false;
      }
    }
    if (!taken) break;
  }
  ++counts_.unfinished;
  return best;
}

HapticStep BarrierShell::report(const State& state, const Pose& X_WD, double dt_s) {
  const MoveSize device = size_of(move_between(X_WD_before_, X_WD));
  if (device.move_mm > std::max(kJump_mm, kFastestHand_mm_s * dt_s) ||
      device.turn_rad > std::max(kJump_rad, kFastestHand_rad_s * dt_s)) {
    ramp_ = 0;
    ramp_from_ = sent_;
  }
  HapticStep result;
  result.X_WT = X_WT_;
  result.contacts = state.sum.touching;
  result.burr_force_W_N = X_WT_.orientation * state.burr_force_T;
  result.wrench = coupling_.wrench_on_hand(X_WT_, X_WD);
  if (ramp_ < 1) {
    ramp_ = std::min(1.0, ramp_ + std::max(0.0, dt_s) / kRamp_s);
    result.wrench = ramp_ * result.wrench + (1 - ramp_) * ramp_from_;
    // Scales the cutting force too: milling must not exceed the work of the hand.
    result.burr_force_W_N *= ramp_;
  }
  sent_ = result.wrench;
  return result;
}

HapticStep BarrierShell::step(const Pose& X_WD, double dt_s) noexcept {
  bricks_.begin_tick(tool_, X_WT_);
  ++counts_.ticks;
  if (!has_pose_) X_WD_before_ = X_WD;
  // At the start a tool whose centreline is in bone follows the device without force until it is outside. Any
  // other tool counts as coming from outside, even if its surface overlaps bone.
  if (started_inside_bone_ || !has_pose_) {
    started_inside_bone_ = count_in_bone(*volume_, centreline_T_, X_WD) > 0;
    X_WT_ = X_WD;
    has_begun_ = false;
  }
  if (!has_begun_) begin_outside(X_WD);
  HapticStep result;
  if (started_inside_bone_) {
    result.X_WT = X_WT_;
    sent_ = {};
  } else {
    const Pose start = X_WT_;
    const State state = solve(X_WD, dt_s);
    X_WT_ = state.X_WT;
    energy_before_Nmm_ = state.sum.energy_Nmm;
    has_energy_ = true;
    near_.list_supporting(measured_, barrier_.width_mm, bricks_);
    grow_cores(state.sum.nearest_mm, dt_s);
    no_go_barriers_.follow(X_WT_.position_mm);
    last_move_ = size_of(move_between(start, X_WT_));
    result = report(state, X_WD, dt_s);
  }
  result.pending_bricks = static_cast<int>(bricks_.pending_count());
  has_pose_ = true;
  X_WD_before_ = X_WD;
  return result;
}

}  // namespace osteomill::barrier_shell
