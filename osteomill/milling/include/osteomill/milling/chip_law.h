#pragma once

#include <span>

namespace osteomill {

/// The rule by which the burr's force becomes removed bone: a constant energy for each mm^3
/// (`CuttingSettings`), or an energy that grows as chips get thinner (`ChipLaw`).
enum class CuttingLaw { constant_energy, chips };

/// The edge of a burr: fluted steel or carbide, or diamond grains. Its shape is always a sphere.
enum class BurrEdge { cutting, diamond };

/// A number of a table with where it comes from: a publication, or "assumed" with the reason.
struct Sourced {
  double value;
  const char* source;
};

/// A material as the law knows it, by its density above the surroundings as a share of the scan's reference.
struct Material {
  const char* name;
  Sourced density;
  /// The work to remove 1 mm^3 in chips of 48 um with a sharp edge, N mm/mm^3.
  Sourced energy_Nmm_per_mm3;
};

/// A kind of burr. Its edge needs the work of a sharp one at `chip_mm`, and `(h / chip_mm)^-exponent` times
/// as much in chips of the thickness h.
struct BurrType {
  const char* name;
  Sourced exponent;
  Sourced chip_mm;
  /// The edges that cut in a turn.
  Sourced edges;
  /// The tangential force at the rim as a share of the force that presses.
  Sourced friction;
};

/// Returns the materials in the order of their densities.
std::span<const Material> materials();
/// Returns the kinds of burrs in the order of `BurrEdge`.
std::span<const BurrType> burr_types();

/// Returns the work for 1 mm^3 in chips of 48 um with a sharp edge, N mm/mm^3, for a density above 0 relative
/// to the reference: along a power law between neighbours of the table, and by the density's square beyond.
double chip_energy_Nmm_per_mm3(double density) noexcept;

/// The energy of one edge in the reference: `energy (h / chip_mm)^-exponent` N mm/mm^3.
struct ChipEdge {
  double energy_Nmm_per_mm3 = 0;
  double chip_mm = 0;
  double exponent = 0;
};

/// The numbers of the law for one burr. A mm^3 costs what the dearer of two edges needs, because no burr cuts
/// for less than a sharp one.
struct ChipLaw {
  ChipEdge edge;
  ChipEdge sharp;
  double edges = 1;
  double friction = 0;
  /// The rate as a share of a new burr's.
  double rate_share = 1;
};

/// Returns the law of a burr that has made `earlier_cuts` cuts. Every 20 cuts take 20 % of the rate.
ChipLaw chip_law(BurrEdge burr, double earlier_cuts = 0);

/// The burr as it cuts in a tick.
struct ChipContact {
  /// The force that pays, N: the push times the share of its power at the rim (`rim_share`).
  double force_N = 0;
  double burr_radius_mm = 0;
  double speed_rpm = 0;
  /// The contact's area across the push.
  double area_mm2 = 0;
  /// The bone's density relative to the reference.
  double density = 1;
};

struct ChipCut {
  double rate_mm3_s = 0;
  /// The power at the rim, N mm/s (mW).
  double power_mW = 0;
  double chip_mm = 0;
};

/// Returns how fast the contact is cut: the rate at which the power of the rim pays for chips as thick as
/// that rate makes them, `Q = (P / (u (h1 N n A)^m))^(1 / (1 - m))`. Nothing if force, speed, area or density
/// is not above 0. Safe in the haptic tick.
ChipCut cut_chips(const ChipLaw& law, const ChipContact& contact) noexcept;

}  // namespace osteomill
