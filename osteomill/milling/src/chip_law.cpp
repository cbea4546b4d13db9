#include "osteomill/milling/chip_law.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace osteomill {

namespace {

constexpr const char* kFemur =
    "human femur, torque of a 3.2 mm drill at 1000 and 1500 rpm (MacAvelia 2012, J Biomech Eng 134(12))";
constexpr const char* kSquare = "assumed: cortical bone's, by the square of the density";

constexpr Material kMaterials[] = {
    {"air cells", {0.1, "assumed: thin walls in air, blurred by the scanner"}, {13, kSquare}},
    {"trabecular bone", {0.4, "assumed"}, {208, kSquare}},
    {"cortical bone", {1.0, "assumed: the median of a scan's bone"}, {1300, kFemur}},
    {"dentine", {1.1, "assumed: by mass density, 2.1 against 1.9 g/cm3"}, {1573, kSquare}},
    {"enamel", {1.9, "assumed: a scan's enamel against its dentine"}, {4693, kSquare}},
};

constexpr BurrType kBurrs[] = {
    {"cutting",
     {0.30, kFemur},
     {0.048, kFemur},
     {1, "assumed: runout of 3.5 to 7.8 um exceeds the chip"},
     {0.40, "glass ceramic with a diamond, 0.40 to 0.60 (in-process assessment, abstract); its lower end"}},
    {"diamond",
     {0.80, "bovine bone, cuts of 2 to 10 um: 0.84 of the thrust (James 2013, Med Eng Phys 35:1638)"},
     {0.005, "assumed: between the chips of a drill and of a light hand"},
     {1, "assumed: as a cutting burr"},
     {0.40, "glass ceramic with a diamond, 0.40 to 0.60 (in-process assessment, abstract); its lower end"}},
};

double power_between(double x, double x0, double y0, double x1, double y1) {
  return y0 * std::pow(x / x0, std::log(y1 / y0) / std::log(x1 / x0));
}

// Returns the removal rate of one edge. `swept_mm2_s` is the contact area times the edges that pass per
// second.
double rate_of(const ChipEdge& edge, double power_mW, double energy_share, double swept_mm2_s) {
  const double energy = edge.energy_Nmm_per_mm3 * energy_share;
  if (edge.exponent == 0) return power_mW / energy;
  return std::pow(power_mW / (energy * std::pow(edge.chip_mm * swept_mm2_s, edge.exponent)),
                  1 / (1 - edge.exponent));
}

}  // namespace

std::span<const Material> materials() {
  return kMaterials;
}

std::span<const BurrType> burr_types() {
  return kBurrs;
}

double chip_energy_Nmm_per_mm3(double density) noexcept {
  const auto square_of = [density](const Material& m) {
    const double share = density / m.density.value;
    return m.energy_Nmm_per_mm3.value * share * share;
  };
  const Material* above =
      std::ranges::find_if(kMaterials, [density](const Material& m) { return m.density.value >= density; });
  if (above == std::begin(kMaterials)) return square_of(*above);
  const Material& below = *std::prev(above);
  if (above == std::end(kMaterials)) return square_of(below);
  return power_between(density, below.density.value, below.energy_Nmm_per_mm3.value, above->density.value,
                       above->energy_Nmm_per_mm3.value);
}

ChipLaw chip_law(BurrEdge burr, double earlier_cuts) {
  constexpr double kShareAfter20 = 0.8;  // -20 % after 20 cuts in ceramic (J Prosthodont 2000 9:66).
  const BurrType& type = kBurrs[static_cast<std::size_t>(burr)];
  ChipLaw law;
  law.sharp = {chip_energy_Nmm_per_mm3(1), kBurrs[0].chip_mm.value, kBurrs[0].exponent.value};
  const double sharp_Nmm_per_mm3 =
      law.sharp.energy_Nmm_per_mm3 * std::pow(type.chip_mm.value / law.sharp.chip_mm, -law.sharp.exponent);
  law.edge = {sharp_Nmm_per_mm3, type.chip_mm.value, type.exponent.value};
  law.edges = type.edges.value;
  law.friction = type.friction.value;
  law.rate_share = std::pow(kShareAfter20, earlier_cuts / 20);
  return law;
}

ChipCut cut_chips(const ChipLaw& law, const ChipContact& contact) noexcept {
  const double turns_per_s = contact.speed_rpm / 60;
  const double power_mW =
      law.friction * contact.force_N * 2 * std::numbers::pi * turns_per_s * contact.burr_radius_mm;
  const double swept_mm2_s = law.edges * turns_per_s * contact.area_mm2;
  if (!(power_mW > 0) || !(swept_mm2_s > 0) || !(contact.density > 0)) return {};
  const double energy_share = chip_energy_Nmm_per_mm3(contact.density) / chip_energy_Nmm_per_mm3(1);
  const double rate_mm3_s =
      law.rate_share * std::min(rate_of(law.edge, power_mW, energy_share, swept_mm2_s),
                                rate_of(law.sharp, power_mW, energy_share, swept_mm2_s));
  return {rate_mm3_s, power_mW, rate_mm3_s / swept_mm2_s};
}

}  // namespace osteomill
