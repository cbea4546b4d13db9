#include "osteomill/report/median_interval.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "osteomill/numbers/distribution.h"

namespace osteomill {

MedianInterval median_interval(std::span<const double> values, double coverage) {
  if (values.empty()) return {};
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  // P(Binomial(n, 1/2) = k) and P(Binomial(n, 1/2) < k).
  double exactly = std::ldexp(1.0, -static_cast<int>(n));
  double below = exactly;
  const bool is_range = 1 - 2 * below < coverage;
  std::size_t k = 1;
  while (!is_range && 2 * (k + 1) <= n) {
    exactly *= static_cast<double>(n - k + 1) / static_cast<double>(k);
    if (1 - 2 * (below + exactly) < coverage) break;
    below += exactly;
    ++k;
  }
  return {distribution_of(sorted).median, sorted[k - 1], sorted[n - k], std::max(0.0, 1 - 2 * below),
          is_range};
}

}  // namespace osteomill
