#include "osteomill/geometry/wrench.h"

#include <cmath>

namespace osteomill {

namespace {

bool clamp_length(Vec3& vector, double limit) {
  const double length = vector.norm();
  if (length <= limit) return false;
  vector *= limit / length;
  return true;
}

}  // namespace

SafeWrench make_safe(const Wrench& wrench, const WrenchLimits& limits) {
  // A norm that overflows is caught here too: components near the largest double cannot be scaled.
  if (!std::isfinite(wrench.force_N.norm()) || !std::isfinite(wrench.torque_Nmm.norm())) {
    return {Wrench{}, WrenchFault::not_finite};
  }
  SafeWrench safe{wrench, WrenchFault::none};
  const bool force = clamp_length(safe.wrench.force_N, limits.force_N);
  const bool torque = clamp_length(safe.wrench.torque_Nmm, limits.torque_Nmm);
  safe.fault = static_cast<WrenchFault>((force ? 1 : 0) + (torque ? 2 : 0));
  return safe;
}

}  // namespace osteomill
