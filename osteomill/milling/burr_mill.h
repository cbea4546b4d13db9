#pragma once

#include <vector>

#include "osteomill/geometry/pose.h"
#include "osteomill/milling/burr_reach.h"
#include "osteomill/milling/cutting_power.h"
#include "osteomill/tool/milling_tool.h"
#include "osteomill/volume/densities.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

struct MillingSettings {
  /// kappa: mm^3 of reference density removed a newton of burr force and second.
  double removal_rate_mm3_per_Ns =
      osteomill::removal_rate_mm3_per_Ns(CuttingSettings{}, MillingTool{}.burr_radius_mm);
  /// How far beyond the burr's radius it still cuts, in voxels (of the largest spacing). With less than 1, a
  /// burr that touches the isosurface without sinking in stalls on dense bone: the surface of enamel lies up
  /// to 1 - isovalue / density voxels before the voxels that make it.
  double reach_voxels = 1.0;
};

/// What one step of milling did.
struct MillingStep {
  VolumeChange change;
  /// In mm^3 of reference density: what was taken, each voxel charged by its density above the surroundings.
  /// Summed from the densities as they were written, so that it is exact for the volume as it now stands.
  double removed_mm3 = 0;
};

/// Removes bone where the burr presses on it, by energy: each step may take kappa * force * dt, spread over
/// the voxels that the burr overlaps, hardest to the deepest. What could not be spent is carried over, so
/// that neither haptic rate nor voxel size changes the hole.
///
/// The carry is what a burr may cut later without pressing for it, so it has two limits. It never exceeds the
/// charge of half a voxel's thickness of reference bone under half the burr (2 pi r^2 * spacing / 2):
/// pressing on where nothing is left in reach saves up no deeper bite. And it is forgotten after 50 ms
/// without force: a burr lifted off owes nothing to the place it touches next. Cutting without pause meets
/// neither limit.
///
/// Where the burr overlaps more than about five hundred voxels, a step looks at every second line of the
/// grid, or at every fourth, ... sixty-fourth, in turn, and spends all of its budget there: so a step's time
/// is bounded whatever the burr and the voxels.
///
/// Not in the paper, whose milling rule is in earlier work; docs/algorithms.md.
class BurrMill {
 public:
  /// Allocates all that `step` needs for this grid and burr. Throws std::invalid_argument where a radius,
  /// rate or reach is out of range or the reference is not denser than the surroundings.
  BurrMill(const GridGeometry& geometry, double burr_radius_mm, const BoneDensities& densities,
           const MillingSettings& settings);

  /// `burr_centre_W` is the simulated burr's centre, `burr_force_W_N` its force on the bone. Lowers densities
  /// of `volume`, whose geometry is the one given at construction, never below the surroundings. Takes
  /// nothing where the force or the centre is not finite. Safe in the haptic tick; time grows with the voxels
  /// overlapped. From step to step only voxels new in reach are searched for bone, so between two calls of
  /// `reset` nobody may raise densities of the same volume.
  MillingStep step(Volume& volume, const Vec3& burr_centre_W, const Vec3& burr_force_W_N, double dt_s);
  /// Forgets the carry and what was in reach.
  void reset();
  /// What was pressed for and not yet cut, mm^3 of reference density.
  double carry_mm3() const { return carry_mm3_; }

 private:
  void share_after(std::size_t found);
  void sum_overlaps(double rate, double& emptied, double& depths) const;
  double drop_per_depth(double density_budget) const;
  MillingStep lower_overlaps(Volume& volume, double drop_per_depth);

  double mm3_per_density_;
  double removal_rate_mm3_per_Ns_;
  double max_carry_mm3_;
  float floor_density_;
  BurrReach reach_;
  BurrReach::Share share_;
  std::size_t found_of_round_ = 0;  // since all lines had their turn
  std::vector<float> lowered_;      // the new densities of what is in reach

  double carry_mm3_ = 0;
  double force_free_s_ = 0;
};

}  // namespace osteomill
