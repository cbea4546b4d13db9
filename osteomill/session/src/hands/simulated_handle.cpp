#include "osteomill/session/simulated_handle.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "osteomill/base/positive.h"

namespace osteomill {

namespace {

// 1 N = 1 kg m/s^2 = 1000 kg mm/s^2, and 1 N mm = 1e-3 N m.
constexpr double kMmPerM = 1000.0;
constexpr double kMaxDelay_s = 1.0;

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(std::string("simulated handle: ") + what);
}

std::size_t delay_substeps(const HandleSettings& settings) {
  return static_cast<std::size_t>(std::llround(settings.force_delay_s / settings.substep_s));
}

Vec3 rounded_to(const Vec3& value, double step) {
  if (step == 0) return value;
  return step *
         Vec3(std::round(value.x() / step), std::round(value.y() / step), std::round(value.z() / step));
}

}  // namespace

void require_valid(const HandleSettings& settings) {
  require(is_positive(settings.mass_kg), "the mass must be a positive number of kg");
  require(is_positive(settings.inertia_kg_m2), "the inertia must be a positive number of kg m^2");
  require(is_not_negative(settings.position_step_mm), "the encoder's step must not be negative (mm)");
  require(is_not_negative(settings.rotation_step_rad),
          "the encoder's rotation step must not be negative (rad)");
  require(is_positive(settings.substep_s) && settings.substep_s <= 1e-3, "the substep must lie in (0, 1 ms]");
  require(is_not_negative(settings.force_delay_s) && settings.force_delay_s <= kMaxDelay_s,
          "the force's delay must lie in [0, 1 s]");
  require(is_not_negative(settings.limits.force_N) && is_not_negative(settings.limits.torque_Nmm),
          "the limits of force (N) and torque (N mm) must not be negative");
}

SimulatedHandle::SimulatedHandle(const HandleSettings& settings, const Pose& X_WD) : settings_(settings) {
  require_valid(settings);
  delay_line_.resize(delay_substeps(settings) + 1);
  reset(X_WD);
}

void SimulatedHandle::reset(const Pose& X_WD) noexcept {
  X_WD_ = X_WD;
  home_orientation_ = X_WD.orientation;
  velocity_ = {};
  commanded_ = {};
  motor_wrench_ = {};
  oldest_ = 0;
  std::fill(delay_line_.begin(), delay_line_.end(), Wrench{});
}

Pose SimulatedHandle::read() const noexcept {
  const Vec3 turned = rotation_vector(home_orientation_.conjugate() * X_WD_.orientation);
  const Vec3 turned_as_read = rounded_to(turned, settings_.rotation_step_rad);
  return {rounded_to(X_WD_.position_mm, settings_.position_step_mm),
          (home_orientation_ * quaternion_from_rotation_vector(turned_as_read)).normalized()};
}

void SimulatedHandle::command(const Wrench& wrench) noexcept {
  commanded_ = make_safe(wrench, settings_.limits).wrench;
}

void SimulatedHandle::advance(const Wrench& other) noexcept {
  // The newest command overwrites the one used in the last substep; the oldest one left was given
  // `force_delay_s` ago.
  const std::size_t newest = oldest_;
  delay_line_[newest] = commanded_;
  oldest_ = (oldest_ + 1) % delay_line_.size();
  motor_wrench_ = delay_line_[oldest_];

  const double h = settings_.substep_s;
  const Wrench all = motor_wrench_ + other;
  velocity_.linear_mm_s += h * (kMmPerM / settings_.mass_kg) * all.force_N;
  velocity_.angular_rad_s += h / (kMmPerM * settings_.inertia_kg_m2) * all.torque_Nmm;
  X_WD_.position_mm += h * velocity_.linear_mm_s;
  X_WD_.orientation =
      (quaternion_from_rotation_vector(h * velocity_.angular_rad_s) * X_WD_.orientation).normalized();
}

double SimulatedHandle::kinetic_energy_Nmm() const {
  return 0.5 * settings_.mass_kg * velocity_.linear_mm_s.squaredNorm() / kMmPerM +
         0.5 * settings_.inertia_kg_m2 * kMmPerM * velocity_.angular_rad_s.squaredNorm();
}

}  // namespace osteomill
