#pragma once

#include <limits>

#include "osteomill/geometry/wrench.h"

namespace osteomill {

/// How fast force and torque may change, as vectors; any, where not set.
struct WrenchRates {
  static constexpr double kAny = std::numeric_limits<double>::infinity();
  double force_N_s = kAny;
  double torque_Nmm_s = kAny;
};

/// For a person's hand: 20 N and 500 N mm are gone within 5 ms.
inline constexpr WrenchRates kRatesForAHand{4000, 1e5};

/// `to`, or as far towards it from `from` as may be in `dt_s`. Safe in the haptic tick.
Wrench approach(const Wrench& from, const Wrench& to, const WrenchRates& rates, double dt_s);

/// True where nothing at all is sent.
bool is_zero(const Wrench& wrench);

}  // namespace osteomill
