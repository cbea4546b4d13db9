#include "osteomill/volume/density_hash.h"

#include "osteomill/volume/density_grid.h"

namespace osteomill {

std::uint64_t fingerprint_of(const DensityGrid& grid) {
  WordHash hash;
  for (const float density : grid.densities()) hash.add(std::bit_cast<std::uint32_t>(density));
  return hash.value();
}

}  // namespace osteomill
