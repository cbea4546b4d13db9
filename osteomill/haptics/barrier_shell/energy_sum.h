#pragma once

#include <limits>

#include <Eigen/Core>

#include "osteomill/haptics/barrier_shell/barrier.h"
#include "osteomill/haptics/barrier_shell/cores.h"

namespace osteomill::barrier_shell {

/// A move of the tool (mm, rad) and what is dual to it (N, N mm), both in T's axes about the burr's centre.
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// The barrier's energy over some points, and its derivatives by a move of the tool, x(t) = x + R t delta,
/// R(t) = R exp(t omega), at t = 0. Safe in the haptic tick.
struct EnergySum {
  double energy_Nmm = 0;
  Vector6 gradient = Vector6::Zero();
  /// The second derivative is `convex` + `rest`; `convex` alone is positive semi-definite.
  Matrix6 convex = Matrix6::Zero();
  Matrix6 rest = Matrix6::Zero();
  int touching = 0;
  double nearest_mm = std::numeric_limits<double>::infinity();

  EnergySum& operator+=(const EnergySum& other);
  /// Adds one point at `point_T`, `distance` from a core, that stands for `area_mm2` of surface: the plain
  /// way, for every core.
  void add_point(const Barrier& barrier, const Vec3& point_T, const CoreDistance& distance, double area_mm2);
};

}  // namespace osteomill::barrier_shell
