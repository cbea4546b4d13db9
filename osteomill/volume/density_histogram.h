#pragma once

#include <array>

#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// How often densities occur, for the isovalue to be chosen by: logarithms of counts, over all densities but
/// the rarest at both ends.
struct DensityHistogram {
  float min = 0;
  float max = 1;
  std::array<float, 128> log_counts{};
};
DensityHistogram histogram_of(const DensityGrid& grid);

}  // namespace osteomill
