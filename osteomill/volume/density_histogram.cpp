#include "osteomill/volume/density_histogram.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace osteomill {

DensityHistogram histogram_of(const DensityGrid& grid) {
  // An odd number, so that not all come from the same columns.
  constexpr std::size_t kEnough = 1'000'000;
  const std::size_t every = std::max<std::size_t>(7, grid.densities().size() / kEnough | 1);
  std::vector<float> sample;
  for (std::size_t n = 0; n < grid.densities().size(); n += every) sample.push_back(grid.densities()[n]);
  std::sort(sample.begin(), sample.end());
  const std::size_t rare = sample.size() / 2000;
  DensityHistogram histogram;
  histogram.min = sample[rare];
  histogram.max = std::max(sample[sample.size() - 1 - rare], histogram.min + 1);
  const float width = (histogram.max - histogram.min) / static_cast<float>(histogram.log_counts.size());
  for (const float density : sample) {
    const auto bin = static_cast<std::ptrdiff_t>((density - histogram.min) / width);
    if (bin >= 0 && bin < std::ssize(histogram.log_counts))
      histogram.log_counts[static_cast<std::size_t>(bin)] += 1;
  }
  for (float& count : histogram.log_counts) count = std::log1p(count);
  return histogram;
}

}  // namespace osteomill
