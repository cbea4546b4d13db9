#pragma once

#include <cstddef>
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
/// Not in the paper, whose milling rule is in earlier work; docs/algorithms.md.
class BurrMill {
 public:
  /// Allocates all that `step` needs for this grid and burr. Throws std::invalid_argument where a radius,
  /// rate or reach is out of range or the reference is not denser than the surroundings.
  BurrMill(const GridGeometry& geometry, double burr_radius_mm, const BoneDensities& densities,
           const MillingSettings& settings);

  /// `burr_centre_W` is the simulated burr's centre, `burr_force_N` >= 0. Lowers densities of `volume`, whose
  /// geometry is the one given at construction, never below the surroundings. Takes nothing where the force
  /// or the centre is not finite. Safe in the haptic tick; time grows with the voxels overlapped.
  MillingStep step(Volume& volume, const Vec3& burr_centre_W, double burr_force_N, double dt_s);
  /// Forgets the carry.
  void reset();
  /// What was pressed for and not yet cut, mm^3 of reference density.
  double carry_mm3() const { return carry_mm3_; }

 private:
  /// A voxel that the burr overlaps and that still holds something.
  struct Overlap {
    int i;
    float depth_mm;
    float density_left;
  };
  /// The overlaps in one row of voxels: [begin, end) of `overlaps_`.
  struct Row {
    int j;
    int k;
    std::size_t begin;
    std::size_t end;
  };

  void find_overlaps(const Volume& volume, const Vec3& burr_centre_W);
  void add_row(const float* row_densities, int first_i, int last_i, int j, int k, const Vec3& centre_mm);
  double drop_per_depth(double density_budget) const;
  MillingStep lower_overlaps(Volume& volume, double drop_per_depth) const;

  GridGeometry geometry_;
  double cutting_radius_mm_;
  double mm3_per_density_;
  double removal_rate_mm3_per_Ns_;
  double greatest_carry_mm3_;
  float floor_density_;

  double carry_mm3_ = 0;
  double force_free_s_ = 0;
  std::vector<Overlap> overlaps_;
  std::vector<Row> rows_;
};

}  // namespace osteomill
