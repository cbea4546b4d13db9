#include "osteomill/volume/volume.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace osteomill {

Volume::Volume(DensityGrid grid, double isovalue)
    : grid_(std::move(grid)), bricks_(grid_), isovalue_(isovalue) {
  if (!std::isfinite(isovalue)) throw std::invalid_argument("Volume: the isovalue is not finite");
}

}  // namespace osteomill
