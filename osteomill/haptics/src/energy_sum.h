#pragma once

#include <limits>

#include <Eigen/Core>

#include "osteomill/base/pose.h"

namespace osteomill {

/// A motion of the tool (delta in mm, then omega in rad), or its dual (N, N mm), both in T's axes about the
/// burr's centre: x(t) = x + R t delta, R(t) = R exp(t omega), t from 0 to 1.
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Energy of a set of points and its derivatives with respect to tool motion, at t = 0. For contacts without
/// an energy, only `gradient` (their push) and `convex` are set. Safe in the haptic tick.
struct EnergySum {
  double energy_Nmm = 0;
  Vector6 gradient = Vector6::Zero();
  /// The second derivative is `convex` + `rest`; `convex` alone is positive semi-definite.
  Matrix6 convex = Matrix6::Zero();
  Matrix6 rest = Matrix6::Zero();
  int touching = 0;
  double nearest_mm = std::numeric_limits<double>::infinity();

  EnergySum& operator+=(const EnergySum& other);
};

}  // namespace osteomill
