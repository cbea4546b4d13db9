#pragma once

#include <optional>
#include <string>
#include <vector>

#include "osteomill/haptics/algorithm_id.h"

namespace osteomill {

/// What the user may say of the algorithms; what is left open takes the algorithm's own default
/// (docs/algorithms.md lists them).
struct HapticSettings {
  Mode mode = Mode::steady;
  /// The spring of 1 and 2, the translational virtual coupling of 3.
  std::optional<double> stiffness_N_per_mm;
  /// The rotational virtual coupling of 3.
  std::optional<double> torsional_stiffness_Nmm_per_rad;
  /// Vertices of 1, the burr's centre included.
  std::optional<int> vertices;
  /// Slices of 2 along the shaft.
  std::optional<int> slices;
  /// Coarseness of the shell of 3: 1 takes every surface voxel.
  std::optional<int> shell_scale;
  /// Settings of one algorithm by its own names, after all others: the switches that tell `steady` from
  /// `paper`.
  struct Named {
    AlgorithmId algorithm;
    std::string name;
    double value;
  };
  std::vector<Named> named;
};

}  // namespace osteomill
