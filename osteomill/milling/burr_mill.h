#pragma once

#include <vector>

#include "osteomill/geometry/pose.h"
#include "osteomill/volume/densities.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

struct MillingSettings {
  /// kappa: mm^3 of reference density removed a newton of burr force and second.
  double removal_rate_mm3_per_Ns = 2.0;
  /// How far beyond the burr's radius it still cuts, in voxels (of the smallest spacing).
  double reach_voxels = 0.5;
};

/// What one step of milling did.
struct MillingStep {
  VolumeChange change;
  /// In mm^3 of reference density: what was taken, each voxel charged by its density above the surroundings.
  double removed_mm3 = 0;
};

/// Removes bone where the burr presses on it, by energy: each step may take kappa * force * dt, spread over
/// the voxels that the burr overlaps, hardest to the deepest. What could not be spent is carried over, so
/// that neither haptic rate nor voxel size changes the hole.
class BurrMill {
 public:
  /// Allocates all that `step` needs for this grid and burr.
  BurrMill(const GridGeometry& geometry, double burr_radius_mm, const BoneDensities& densities,
           const MillingSettings& settings);

  /// `burr_centre_W` is the simulated burr's centre, `burr_force_N` >= 0. Lowers densities of `volume`.
  /// Safe in the haptic tick.
  MillingStep step(Volume& volume, const Vec3& burr_centre_W, double burr_force_N, double dt_s);
  void reset();

 private:
  // (yours to shape)
};

}  // namespace osteomill
