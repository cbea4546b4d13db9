#include "osteomill/session/milling_session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "osteomill/base/positive.h"
#include "osteomill/haptics/sample_points.h"
#include "osteomill/milling/pressing_reach.h"
#include "osteomill/volume/sampling.h"

namespace osteomill {

namespace {

using Clock = std::chrono::steady_clock;

double microseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

const Vec3 kNotANumber = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
const Wrench kNotFinite{kNotANumber, Vec3::Zero()};
const Pose kNoPose{kNotANumber, Quat::Identity()};

// Returns whether the tick has a pose of the tool: without a finite pose or wrench it does not compute one.
bool has_tool(WrenchFault fault) {
  return fault != WrenchFault::pose_not_finite && fault != WrenchFault::not_finite;
}

// Returns `bone` after checking that the guard's settings are valid, the tool can work in the bone, and the
// algorithm supports the guards of its structures.
std::shared_ptr<Volume> checked_bone(const MillingSetup& setup, std::shared_ptr<Volume> bone) {
  require_workable(setup.guard);
  require_workable(setup.tool, bone->geometry());
  if (bone->no_go() && count_guards(*bone->no_go()) > 0 && !setup.algorithm.has_guards) {
    throw std::invalid_argument(setup.algorithm.id.name +
                                " cannot hold the burr off structures, as their guard_mm asks");
  }
  return bone;
}

// Returns sample points `by_mm` below the tool's surface.
std::vector<Vec3> points_inside(const MillingTool& tool, double by_mm) {
  constexpr int kOnBurr = 64;
  constexpr double kSlice_mm = 0.5;
  std::vector<Vec3> points_T;
  for (const Vec3& direction : spiral_directions(kOnBurr))
    points_T.push_back(std::max(0.0, tool.burr_radius_mm - by_mm) * direction);
  const double share = std::max(0.0, 1 - by_mm / tool.shaft_radius_mm);
  const int slices = std::max(1, static_cast<int>(std::ceil(tool.shaft_length_mm / kSlice_mm)));
  for (const ShaftSlice& slice : slice_vertices(tool, slices)) {
    for (const Vec3& vertex : slice.vertices_T)
      points_T.push_back(slice.centre_T + share * (vertex - slice.centre_T));
  }
  return points_T;
}

constexpr double kLoneTick_s = 1e-3;

double tick_length_s(const std::vector<TrajectoryPoint>& trajectory, std::size_t n) {
  if (trajectory.size() < 2) return kLoneTick_s;
  const std::size_t end = n == 0 ? 1 : n;
  return trajectory[end].time_s - trajectory[end - 1].time_s;
}

}  // namespace

double vibration_hz(double spindle_speed_rpm) {
  // The highest speed that the settings allow maps to kMax_hz.
  constexpr double kTrue_hz = 100, kMax_hz = 250, kFastest_hz = 1e6 / 60;
  const double turns_per_s = spindle_speed_rpm / 60;
  if (turns_per_s <= kTrue_hz) return turns_per_s;
  return kTrue_hz +
         (kMax_hz - kTrue_hz) * std::log(turns_per_s / kTrue_hz) / std::log(kFastest_hz / kTrue_hz);
}

Vec3 Vibration::force_N(const Pose& X_WT, double cutting_N, double spindle_rpm, double dt_s) noexcept {
  if (!settings_.on || !(cutting_N > 0) || !std::isfinite(cutting_N) || !(spindle_rpm > 0))
    return Vec3::Zero();
  turns_ += vibration_hz(spindle_rpm) * dt_s;
  turns_ -= std::floor(turns_);
  const double amplitude_N = std::min(settings_.force_share * cutting_N, settings_.max_N);
  const double angle = 2 * std::numbers::pi * turns_;
  return X_WT.orientation * Vec3(amplitude_N * std::cos(angle), amplitude_N * std::sin(angle), 0);
}

MillingSession::MillingSession(std::shared_ptr<Volume> bone, const BoneDensities& densities,
                               const MillingSetup& setup)
    : volume_(checked_bone(setup, std::move(bone))),
      setup_(setup),
      densities_(densities),
      algorithm_(make_algorithm(setup.algorithm, setup.haptics)),
      milling_(milling_settings(setup)),
      mill_(*volume_, setup.tool.burr_radius_mm, densities, milling_),
      reaction_(milling_, setup.tool.burr_radius_mm),
      no_go_(volume_->labels(), setup.tool.burr_radius_mm),
      spindle_(setup.handpiece, setup.cutting.spindle_speed_rpm),
      vibration_(setup.vibration),
      transient_(setup.contact_transient),
      guard_(setup.guard),
      points_inside_T_(points_inside(setup.tool, pressing_reach_mm(volume_->geometry()))) {
  algorithm_->prepare({volume_.get(), setup.tool, setup.tick_s});
}

// An invalid tick length would corrupt everything that is integrated over ticks.
double MillingSession::usable_tick_s(double dt_s) const noexcept {
  return is_positive(dt_s) ? dt_s : setup_.tick_s;
}

TickRecord MillingSession::begin_record(Device& device, const TickInput& input) {
  const double late_s = is_positive(input.late_s) ? input.late_s : 0;
  if (late_s > 0 && last_X_WT_) device.tick_done(*last_X_WT_, late_s);
  TickRecord record;
  record.time_s = input.time_s;
  record.dt_s = usable_tick_s(input.dt_s) + late_s;
  record.paused = input.paused;
  record.fade_out = std::exchange(fade_out_requested_, false);
  if (record.fade_out) guard_.fade_out();
  record.X_WD = device.read_pose();
  // Beyond the range of any device; voxel indices would overflow.
  if (!is_reachable(record.X_WD)) record.X_WD = kNoPose;
  record.delivered_fraction = device.delivered_fraction();
  record.driven = device.is_driven() && !std::exchange(hold_back_requested_, false);
  if (!record.driven) guard_.hold_back();
  record.spindle_on = !input.paused && input.spindle_on.value_or(device.is_spindle_requested());
  spindle_.step(record.spindle_on, load_Nmm_, record.dt_s);
  record.spindle_rpm = spindle_.speed_rpm();
  record.cutting_power_W = record.cut_density = load_Nmm_ = 0;
  if (place_requested_ && is_finite(record.X_WD)) {
    place_requested_ = false;
    record.placed = true;
    begin_at(record.X_WD);
  }
  return record;
}

TickRecord MillingSession::tick(Device& device, const TickInput& input) {
  try {
    return tick_of(device, input);
  } catch (...) {
    // Only the device throws. The hand's wrench is unknown; send zero until the tool is out of bone.
    guard_.hold_back();
    try {
      device.write_wrench({});
    } catch (...) {
      // Report the first failure.
    }
    throw;
  }
}

TickRecord MillingSession::tick_of(Device& device, const TickInput& input) {
  TickRecord record = begin_record(device, input);
  last_change_ = {};
  if (input.paused) {
    pause(device, record);
  } else {
    work(device, record);
  }
  record.energy_given_Nmm = guard_.energy_given_Nmm();
  record.removed_mm3 = removed_mm3_;
  if (volume_->no_go())
    record.no_go_distance_mm =
        no_go_distance_mm(*volume_->no_go(), record.X_WT.position_mm, setup_.tool.burr_radius_mm);
  record.bone_hash = volume_->change_hash();
  device.tick_done(last_X_WT_.value_or(record.X_WD), usable_tick_s(input.dt_s));
  return record;
}

void MillingSession::work(Device& device, TickRecord& record) {
  const Clock::time_point start = Clock::now();
  auto [step, safe, cutting_torque_W_Nmm, shaft_drag] =
      step_safely(record.X_WD, record.dt_s, record.spindle_on, record.driven);
  // Only the force that the hand delivers pays for removal.
  step.burr_force_W_N *= record.delivered_fraction;
  record.compute_us = microseconds_since(start);
  record.fault = safe.fault;
  device.write_wrench(safe.wrench);

  const Clock::time_point milling_start = Clock::now();
  mill(step, shaft_drag, record);
  record.label_cuts = mill_.by_label().take();
  record.milling_us = microseconds_since(milling_start);

  record.X_WT = step.X_WT;
  record.wrench = safe.wrench;
  record.cutting_torque_W_Nmm = cutting_torque_W_Nmm;
  record.contacts = step.contacts;
  record.pending_bricks = step.pending_bricks;
  intersection_W_ = step.intersection_W;
  record.burr_force_W_N = step.burr_force_W_N;
}

void MillingSession::pause(Device& device, TickRecord& record) {
  record.X_WT = last_X_WT_.value_or(Pose{});
  record.wrench = guard_.filter_zero(record.X_WD, record.dt_s).wrench;
  device.write_wrench(record.wrench);
  reaction_.reset();
  intersection_W_.reset();
}

void MillingSession::resume_from(const SessionHandover& before) noexcept {
  spindle_.begin_from(before.spindle_rpm);
  guard_.begin_from(before.sent, before.held_back);
  if (before.X_WT && is_finite(*before.X_WT)) begin_at(*before.X_WT);
}

void MillingSession::begin_at(const Pose& X_WT) noexcept {
  guard_.restart();
  last_X_WT_ = X_WT;
  forget_contacts(X_WT);
}

void MillingSession::forget_contacts(const std::optional<Pose>& X_WT) noexcept {
  constexpr double kUsualTick_s = 1e-3;
  algorithm_->reset();
  reaction_.reset();
  transient_.reset();
  if (X_WT) algorithm_->step(*X_WT, kUsualTick_s);
}

// Returns whether the tool is free of bone. The algorithm's force cannot show that: in the first ticks, and
// deep in bone, some algorithms give none.
bool MillingSession::is_free(const Pose& X_WD) const noexcept {
  const Vec3 end_W = X_WD.position_mm + setup_.tool.shaft_length_mm * shaft_direction(X_WD);
  return !first_crossing(*volume_, X_WD.position_mm, end_W) &&
         std::ranges::none_of(points_inside_T_,
                              [&](const Vec3& point_T) { return is_bone_at(*volume_, X_WD * point_T); });
}

MillingSession::SafeStep MillingSession::step_safely(const Pose& X_WD, double dt_s, bool spindle_on,
                                                     bool is_driven) noexcept {
  HapticStep nothing;
  nothing.X_WT = last_X_WT_.value_or(Pose{});
  if (!is_finite(X_WD)) {
    return {nothing, {guard_.filter_zero(X_WD, dt_s).wrench, WrenchFault::pose_not_finite}};
  }
  HapticStep step = algorithm_->step(X_WD, dt_s);
  ShaftDrag drag;
  if (setup_.drag && spindle_on && spindle_.speed_rpm() > 0) {
    const Wrench contact{step.wrench.force_N + step.burr_force_W_N, step.wrench.torque_Nmm};
    drag = shaft_drag(setup_.tool, step.X_WT, contact);
  }
  if (setup_.contact_transient.on) step.wrench.force_N += transient_.force_N(X_WD, step.wrench.force_N, dt_s);
  if (spindle_on)
    step.wrench.force_N +=
        vibration_.force_N(step.X_WT, vibrating_N(step.burr_force_W_N), spindle_.speed_rpm(), dt_s);
  if (milling_.reaction_share > 0) step.wrench = step.wrench + reaction_.wrench();
  const bool is_usable = is_finite(step.X_WT) && step.burr_force_W_N.allFinite();
  const bool can_release = is_driven && (!guard_.is_held_back() || is_free(X_WD));
  SafeWrench safe = guard_.filter(is_usable ? step.wrench : kNotFinite, X_WD, dt_s, can_release);
  // Report it even if the algorithm, deep in bone, asked for zero anyway.
  if (safe.fault == WrenchFault::none && is_driven && guard_.is_held_back())
    safe.fault = WrenchFault::held_back;
  if (safe.fault == WrenchFault::not_finite) {
    // Discard the contacts that led to the invalid wrench. Restart from the last tool pose, which is outside
    // the bone; the device may have sunk into it.
    forget_contacts(last_X_WT_);
    return {nothing, safe};
  }
  step.burr_force_W_N *= sent_fraction(step.wrench.force_N, safe.wrench.force_N);
  last_X_WT_ = step.X_WT;
  return {step, safe,
          sent_fraction(step.wrench.torque_Nmm, safe.wrench.torque_Nmm) * reaction_.wrench().torque_Nmm,
          drag};
}

// Returns the force that drives the vibration: the whole burr force at constant energy; with the chip law
// scaled by the recent cutting share and the speed, and larger in bone of uneven density.
double MillingSession::vibrating_N(const Vec3& burr_force_W_N) const noexcept {
  if (!milling_.chips) return burr_force_W_N.norm();
  const double speed_share = spindle_.speed_rpm() / spindle_.set_rpm();
  return burr_force_W_N.norm() * cutting_share_ * speed_share * (1 + mill_.cut_bone().grain);
}

void MillingSession::mill(const HapticStep& step, const ShaftDrag& shaft_drag, TickRecord& record) noexcept {
  constexpr double kCutting_s = 0.01;
  const Vec3& force_W_N = step.burr_force_W_N;
  const double force_N = force_W_N.norm(), dt_s = record.dt_s, radius_mm = setup_.tool.burr_radius_mm;
  const Vec3 paying_W_N = paying_force_W_N(milling_, step.X_WT, force_W_N, record.spindle_on);
  const MillingStep cut =
      mill_.step(step.X_WT.position_mm, paying_W_N, dt_s, record.spindle_rpm / milling_.spindle_speed_rpm);
  if (record.spindle_on && has_tool(record.fault))
    no_go_.tally_contacts(step.X_WT.position_mm, mill_.by_label());
  const double paid_share = cut.removed_mm3 > 0 ? cut.removed_mm3 / (cut.rate_mm3_s * dt_s) : 0;
  cutting_share_ += dt_s / (kCutting_s + dt_s) * (std::min(paid_share, 1.0) - cutting_share_);
  double holding_share = paid_share;
  if (record.spindle_on && force_N > 0 && std::isfinite(force_N)) {
    const double rim_N = milling_.tangential_share * force_N *
                         rim_power_fraction(force_W_N / force_N, shaft_direction(step.X_WT));
    const double rim_mm_s = 2 * std::numbers::pi * radius_mm * record.spindle_rpm / 60;
    load_Nmm_ = rim_N * radius_mm;
    // The whole pressing force drags, whether it cuts or not, limited by the drive's stall torque.
    if (setup_.drag) holding_share = std::min(1.0, spindle_.stall_Nmm() / load_Nmm_);
    record.cutting_power_W = paid_share * rim_N * rim_mm_s * 1e-3;
    record.cut_density = mill_.cut_bone().density;
  }
  load_Nmm_ += shaft_drag.torque_Nmm;
  if (milling_.chips || setup_.drag) {
    reaction_.update_from_force(step.X_WT, force_W_N, holding_share * force_N, dt_s, shaft_drag.wrench);
  } else {
    reaction_.follow(step.X_WT, force_W_N, cut.removed_mm3, dt_s);
  }
  last_change_ = cut.change;
  // Not written while nothing is removed, because another thread may then read it
  // (HapticThread::freeze_bone).
  if (cut.removed_mm3 > 0) removed_mm3_ += cut.removed_mm3;
  if (!cut.change.voxels.empty()) algorithm_->volume_changed(cut.change);
}

void replay(MillingSession& session, const std::vector<TrajectoryPoint>& trajectory,
            const std::function<void(const TickRecord&)>& record) {
  PosedDevice device;
  for (std::size_t n = 0; n < trajectory.size(); ++n) {
    const TrajectoryPoint& point = trajectory[n];
    device.put(point.X_WD);
    record(session.tick(
        device, {.time_s = point.time_s, .dt_s = tick_length_s(trajectory, n), .spindle_on = point.milling}));
  }
}

}  // namespace osteomill
