#include "energy_sum.h"

#include <algorithm>

namespace osteomill {

EnergySum& EnergySum::operator+=(const EnergySum& other) {
  energy_Nmm += other.energy_Nmm;
  gradient += other.gradient;
  convex += other.convex;
  rest += other.rest;
  touching += other.touching;
  nearest_mm = std::min(nearest_mm, other.nearest_mm);
  return *this;
}

}  // namespace osteomill
