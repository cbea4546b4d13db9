#pragma once

#include "osteomill/haptics/algorithm_id.h"

namespace osteomill {

/// Settings of algorithm 2, `surface-points` (Eriksson 2012, section 5). The members from `march_to_surface`
/// on are the improvements of `steady`; each may be switched on by itself, and `paper` has none of them.
struct SurfacePointsSettings {
  /// k of (14): the spring of a sphere, or of a slice, all of whose vertices collide.
  double stiffness_N_per_mm = 20.0;
  /// Circles along the free shaft, eight vertices each.
  int slices = 20;

  /// A spring of (15) ends where a walk along its line first meets the bone, not where the density, taken to
  /// be linear between the line's two ends, would cross the isovalue.
  bool march_to_surface = false;
  /// The slices' forces, weighted by 1/slices as (20) weights their torques, are felt as force too.
  bool shaft_force = false;

  static SurfacePointsSettings defaults(Mode mode);
};

/// Throws std::invalid_argument, naming the setting, where one is out of range.
void require_valid(const SurfacePointsSettings& settings);

}  // namespace osteomill
