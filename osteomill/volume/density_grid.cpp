#include "osteomill/volume/density_grid.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "osteomill/numbers/work_progress.h"

namespace osteomill {

DensityGrid::DensityGrid(const GridGeometry& geometry, std::vector<float> densities)
    : geometry_(geometry), densities_(std::move(densities)) {
  if (densities_.empty() || densities_.size() != geometry_.voxel_count()) {
    throw std::invalid_argument("DensityGrid: as many densities as voxels, and at least one");
  }
  constexpr std::size_t kAtOnce = 1 << 22;
  outside_density_ = densities_.front();
  for (std::size_t first = 0; first < densities_.size(); first += kAtOnce) {
    const std::size_t last = std::min(first + kAtOnce, densities_.size());
    outside_density_ =
        std::min(outside_density_, *std::min_element(densities_.begin() + static_cast<std::ptrdiff_t>(first),
                                                     densities_.begin() + static_cast<std::ptrdiff_t>(last)));
    WorkProgress::done(last, densities_.size());
  }
}

}  // namespace osteomill
