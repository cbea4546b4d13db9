#pragma once

#include <algorithm>

namespace osteomill::barrier_shell {

/// Energy of bone near a core, per area of bone surface. With w = `width_mm`, p0 = `pressure_N_per_mm2` and x
/// = 1 - d / w it is psi(d) = (w p0 / 3) x^3 / (1 - x) for distances d < w, else zero. Soft at first touch,
/// infinite at the core, twice continuously differentiable, and without a logarithm. Safe in the tick.
struct Barrier {
  double width_mm;
  double pressure_N_per_mm2;

  /// Share of the width below which the barrier stops growing, so that its values stay finite; no certified
  /// step comes this near.
  static constexpr double kNearestShare = 1e-3;

  /// psi (N/mm), p = -psi' (N/mm^2) and -p' = psi'' (N/mm^3).
  struct Value {
    double energy = 0;
    double pressure = 0;
    double stiffness = 0;
  };
  friend Value operator*(double area_mm2, const Value& v) {
    return {area_mm2 * v.energy, area_mm2 * v.pressure, area_mm2 * v.stiffness};
  }
  Value at(double distance_mm) const {
    const double share = std::max(distance_mm / width_mm, kNearestShare);
    if (!(share < 1)) return {};
    const double x = 1 - share, x2 = x * x;
    const double third = pressure_N_per_mm2 / 3;
    return {width_mm * third * x2 * x / share, third * x2 * (3 - 2 * x) / (share * share),
            third / width_mm * x * (6 - 6 * x + 2 * x2) / (share * share * share)};
  }
};

}  // namespace osteomill::barrier_shell
