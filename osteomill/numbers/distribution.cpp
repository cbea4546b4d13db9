#include "osteomill/numbers/distribution.h"

#include <algorithm>
#include <cmath>

namespace osteomill {

std::size_t nearest_rank(double share, std::size_t count) {
  // A share such as 0.999 is not exact in a double: a product a hair above a whole number is that number.
  const double rank = std::ceil(share * static_cast<double>(count) - 1e-6);
  return std::clamp<std::size_t>(rank > 0 ? static_cast<std::size_t>(rank) : 0, 1,
                                 std::max<std::size_t>(count, 1));
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(nearest_rank(share, values.size()) - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

Distribution distribution_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {0.5 * (values[(n - 1) / 2] + values[n / 2]), values[nearest_rank(0.99, n) - 1], values.back()};
}

}  // namespace osteomill
