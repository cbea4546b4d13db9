#include "osteomill/session/wrench_guard.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "osteomill/base/positive.h"

namespace osteomill {

namespace {

// Clamps the tick length so that a late tick does not permit a larger step.
double usual_tick_s(double dt_s) {
  constexpr double kUsualTick_s = 1e-3;
  return dt_s > 0 ? std::min(dt_s, kUsualTick_s) : 0;
}

// Maximum damping at which a 0.1 kg handle sampled at 1 kHz does not oscillate: a third of m / T.
constexpr double kMaxDamping_Ns_per_mm = 0.03;
// Distance from the grip to the burr, mm; converts rotation into motion at the grip.
constexpr double kLever_mm = 30;

}  // namespace

void PassivityObserver::move_to(const Pose& X_WD) noexcept {
  moved_mm_ = turned_rad_ = Vec3::Zero();
  if (!is_finite(X_WD)) {
    X_WD_.reset();
    return;
  }
  if (X_WD_) {
    moved_mm_ = X_WD.position_mm - X_WD_->position_mm;
    turned_rad_ = rotation_vector(X_WD.orientation * X_WD_->orientation.conjugate());
    energy_given_Nmm_ += sent_.force_N.dot(moved_mm_) + sent_.torque_Nmm.dot(turned_rad_);
  }
  X_WD_ = X_WD;
}

Wrench PassivityObserver::damping(double dt_s) const noexcept {
  constexpr double kLever2_mm2 = kLever_mm * kLever_mm;
  const double motion2_mm2 = moved_mm_.squaredNorm() + kLever2_mm2 * turned_rad_.squaredNorm();
  if (energy_given_Nmm_ <= 0 || motion2_mm2 == 0 || dt_s <= 0) return {};
  const double stiffness_N_per_mm = std::min(energy_given_Nmm_ / motion2_mm2, kMaxDamping_Ns_per_mm / dt_s);
  return {-stiffness_N_per_mm * moved_mm_, -stiffness_N_per_mm * kLever2_mm2 * turned_rad_};
}

GuardSettings GuardSettings::for_simulation(const WrenchLimits& limits, bool passivity_controller) {
  return {limits, WrenchRates{}, 0, kAny, kAny, kAny, passivity_controller};
}

void require_workable(const GuardSettings& settings) {
  require_positive(settings.limits.force_N, "guard.limits.force_N, N,");
  require_positive(settings.limits.torque_Nmm, "guard.limits.torque_Nmm, N mm,");
  require_not_negative(settings.blend_s, "guard.blend_s, s,");
  const auto require_some = [](double value, const std::string& what) {
    if (!(value > 0)) throw std::invalid_argument("guard." + what + " must be above 0; infinity for any");
  };
  require_some(settings.rates.force_N_s, "rates.force_N_s");
  require_some(settings.rates.torque_Nmm_s, "rates.torque_Nmm_s");
  require_some(settings.max_move_mm, "max_move_mm");
  require_some(settings.max_turn_rad, "max_turn_rad");
  require_some(settings.max_tick_s, "max_tick_s");
}

void WrenchGuard::restart() noexcept {
  from_ = sent_;
  blended_ = 0;
  fading_out_ = false;
  X_WD_.reset();
}

void WrenchGuard::begin_from(const Wrench& sent, bool held_back) noexcept {
  held_back_ = false;
  if (held_back) hold_back();
  sent_ = sent;
  observer_.restart(sent);
  restart();
}

void WrenchGuard::hold_back() noexcept {
  if (!(settings_.blend_s > 0)) return;
  held_back_ = true;
  sent_ = {};
  observer_.send(sent_);
}

void WrenchGuard::fade_out() noexcept {
  restart();
  fading_out_ = true;
}

SafeWrench WrenchGuard::approach(const Wrench& target, WrenchFault fault, double dt_s) noexcept {
  sent_ = osteomill::approach(sent_, target, settings_.rates, usual_tick_s(dt_s));
  const bool is_rate_limited = sent_.force_N != target.force_N || sent_.torque_Nmm != target.torque_Nmm;
  observer_.send(sent_);
  return {sent_, is_rate_limited && fault == WrenchFault::none ? WrenchFault::rate_limited : fault};
}

SafeWrench WrenchGuard::filter_zero(const Pose& X_WD, double dt_s) noexcept {
  observer_.move_to(X_WD);
  return send_zero(dt_s);
}

SafeWrench WrenchGuard::send_zero(double dt_s) noexcept {
  SafeWrench safe = approach({}, WrenchFault::none, dt_s);
  from_ = {};
  blended_ = 0;
  X_WD_.reset();
  return safe;
}

SafeWrench WrenchGuard::filter(const Wrench& asked, const Pose& X_WD, double dt_s, bool is_free) noexcept {
  observer_.move_to(X_WD);
  const Wrench damping =
      settings_.passivity_controller && !is_zero(asked) ? observer_.damping(dt_s) : Wrench{};
  const bool is_damped = !is_zero(damping);
  const SafeWrench within = make_safe(is_damped ? asked + damping : asked, settings_.limits);
  WrenchFault fault = within.fault;
  if (fault == WrenchFault::none && is_damped) fault = WrenchFault::rate_limited;
  if (X_WD_ && ((X_WD.position_mm - X_WD_->position_mm).norm() > settings_.max_move_mm ||
                X_WD.orientation.angularDistance(X_WD_->orientation) > settings_.max_turn_rad)) {
    fault = WrenchFault::pose_jumped;
  } else if (dt_s > settings_.max_tick_s) {
    fault = WrenchFault::tick_late;
  }
  if (fault == WrenchFault::not_finite || fault == WrenchFault::pose_jumped ||
      fault == WrenchFault::tick_late) {
    const Wrench sent = send_zero(dt_s).wrench;
    X_WD_ = X_WD;
    return {sent, fault};
  }
  X_WD_ = X_WD;
  if (held_back_ && is_free && within.wrench.force_N.norm() <= kFreeForce_N &&
      within.wrench.torque_Nmm.norm() <= kFreeTorque_Nmm) {
    held_back_ = false;
  }
  if (held_back_) {
    from_ = {};
    blended_ = 0;
    return approach({}, is_zero(within.wrench) ? fault : WrenchFault::held_back, dt_s);
  }
  const Wrench wanted = fading_out_ ? Wrench{} : within.wrench;
  blended_ = settings_.blend_s > 0 ? std::min(1.0, blended_ + usual_tick_s(dt_s) / settings_.blend_s) : 1;
  // No blend in free space.
  if (is_zero(wanted) && is_zero(from_)) blended_ = 1;
  if (blended_ == 1) return approach(wanted, fault, dt_s);
  const Wrench target = (1 - blended_) * from_ + blended_ * wanted;
  return approach(target, fault == WrenchFault::none ? WrenchFault::rate_limited : fault, dt_s);
}

}  // namespace osteomill
