#pragma once

#include <span>

namespace osteomill {

/// The rule by which the burr's force becomes removed bone: a constant energy for each mm^3
/// (`CuttingSettings`), or an energy that grows as chips get thinner (`ChipLaw`).
enum class CuttingLaw { constant_energy, chips };

/// The edge of a burr: fluted steel or carbide, or diamond grains. Its shape is always a sphere.
enum class BurrEdge { cutting, diamond };

/// A table value with its source: a publication, or "assumed" with the reason.
struct Sourced {
  double value;
  const char* source;
};

/// A material of the chip law. Its density is measured above the surroundings, relative to the scan's
/// reference.
struct Material {
  const char* name;
  Sourced density;
  /// Work to remove 1 mm^3 in 48 um chips with a sharp edge, N mm/mm^3.
  Sourced energy_Nmm_per_mm3;
};

/// A kind of burr. At chip thickness `chip_mm` its edge needs the work of a sharp edge, and `(h /
/// chip_mm)^-exponent` times as much at thickness h.
struct BurrType {
  const char* name;
  Sourced exponent;
  Sourced chip_mm;
  /// Cutting edges per turn.
  Sourced edges;
  /// Tangential force at the rim relative to the normal force.
  Sourced friction;
};

/// Returns the materials in ascending density.
std::span<const Material> materials();
/// Returns the kinds of burrs in the order of `BurrEdge`.
std::span<const BurrType> burr_types();

/// Returns the work for 1 mm^3 in 48 um chips with a sharp edge, N mm/mm^3, for a density above 0 relative to
/// the reference. Interpolates between table entries by a power law; extrapolates by the square of the
/// density.
double chip_energy_Nmm_per_mm3(double density) noexcept;

/// Energy of one edge in bone of the reference density: `energy (h / chip_mm)^-exponent` N mm/mm^3.
struct ChipEdge {
  double energy_Nmm_per_mm3 = 0;
  double chip_mm = 0;
  double exponent = 0;
};

/// Parameters of the chip law for one burr. The energy is the larger of the two edges' because no burr cuts
/// for less than a sharp one.
struct ChipLaw {
  ChipEdge edge;
  ChipEdge sharp;
  double edges = 1;
  double friction = 0;
  /// Removal rate relative to a new burr.
  double rate_share = 1;
};

/// Returns the law for a burr that has made `earlier_cuts` cuts. Every 20 cuts reduce the rate by 20 %.
ChipLaw chip_law(BurrEdge burr, double earlier_cuts = 0);

/// State of the cutting burr in one tick.
struct ChipContact {
  /// Force that pays for removal, N: the pressing force times `rim_power_fraction`.
  double force_N = 0;
  double burr_radius_mm = 0;
  double speed_rpm = 0;
  /// Contact area projected along the pressing direction.
  double area_mm2 = 0;
  /// Bone density relative to the reference.
  double density = 1;
};

struct ChipCut {
  double rate_mm3_s = 0;
  /// The power at the rim, N mm/s (mW).
  double power_mW = 0;
  double chip_mm = 0;
};

/// Returns the removal rate at which the rim's power equals the energy for chips of the thickness that this
/// rate produces: `Q = (P / (u (h1 N n A)^m))^(1 / (1 - m))`. Zero if force, speed, area or density is not
/// above 0. Safe in the haptic tick.
ChipCut cut_chips(const ChipLaw& law, const ChipContact& contact) noexcept;

}  // namespace osteomill
