#include "osteomill/geometry/wrench_rates.h"

namespace osteomill {

namespace {

// No limit stays none in a time of no length.
Vec3 towards(const Vec3& from, const Vec3& to, double rate, double dt_s) {
  const double most = rate < WrenchRates::kAny ? rate * dt_s : rate;
  const double way = (to - from).norm();
  return way <= most ? to : Vec3(from + most / way * (to - from));
}

}  // namespace

Wrench approach(const Wrench& from, const Wrench& to, const WrenchRates& rates, double dt_s) {
  return {towards(from.force_N, to.force_N, rates.force_N_s, dt_s),
          towards(from.torque_Nmm, to.torque_Nmm, rates.torque_Nmm_s, dt_s)};
}

bool is_zero(const Wrench& wrench) {
  return wrench.force_N.isZero(0) && wrench.torque_Nmm.isZero(0);
}

}  // namespace osteomill
