#include "osteomill/base/distribution.h"

#include <cmath>
#include <span>

namespace osteomill {

namespace {

double of_ascending(std::span<const double> values, double share) {
  const auto [lower, upper] = percentile_ranks(share, values.size());
  return 0.5 * (values[lower - 1] + values[upper - 1]);
}

}  // namespace

PercentileRanks percentile_ranks(double share, std::size_t count) {
  // A share such as 0.999 is not exact in a double; treats a product this close to a whole number as that
  // number.
  constexpr double kHair = 1e-6;
  const double rank = share * static_cast<double>(count);
  const auto clamped = [&](double number) {
    return std::clamp<std::size_t>(number > 0 ? static_cast<std::size_t>(number) : 0, 1,
                                   std::max<std::size_t>(count, 1));
  };
  return {clamped(std::ceil(rank - kHair)), clamped(std::floor(rank + kHair) + 1)};
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return of_ascending(values, share);
}

Distribution distribution_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return {of_ascending(values, 0.5), of_ascending(values, 0.99), values.back()};
}

}  // namespace osteomill
