#include "osteomill/volume/volume.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace osteomill {

Volume::Volume(DensityGrid grid, double isovalue) : grid_(std::move(grid)), bricks_(grid_) {
  set_isovalue(isovalue);
}

void Volume::set_isovalue(double isovalue) {
  if (!std::isfinite(isovalue)) throw std::invalid_argument("Volume: the isovalue is not finite");
  isovalue_ = isovalue;
}

}  // namespace osteomill
