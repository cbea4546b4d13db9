#include "osteomill/haptics/point_shell/count_pyramid.h"

#include <utility>

namespace osteomill {

CountPyramid::CountPyramid(const std::array<int, 3>& dims) {
  std::array<int, 3> level_dims = dims;
  while (true) {
    Level level{level_dims, {}};
    level.counts.assign(cell_count(level_dims), 0);
    levels_.push_back(std::move(level));
    if (level_dims == std::array<int, 3>{1, 1, 1}) return;
    for (int& dim : level_dims) dim = (dim + 1) / 2;
  }
}

void CountPyramid::add(int i, int j, int k, std::int32_t difference) {
  for (Level& level : levels_) {
    // Unsigned arithmetic wraps: adding a negative difference subtracts.
    level.counts[row_major(level.dims, i, j, k)] += static_cast<std::uint32_t>(difference);
    i /= 2;
    j /= 2;
    k /= 2;
  }
}

}  // namespace osteomill
