#include "osteomill/volume/density_grid.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace osteomill {

DensityGrid::DensityGrid(const GridGeometry& geometry, std::vector<float> densities)
    : geometry_(geometry), densities_(std::move(densities)) {
  if (densities_.empty() || densities_.size() != geometry_.voxel_count()) {
    throw std::invalid_argument("DensityGrid: as many densities as voxels, and at least one");
  }
  outside_density_ = *std::min_element(densities_.begin(), densities_.end());
}

}  // namespace osteomill
