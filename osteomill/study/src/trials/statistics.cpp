#include "trials/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <fmt/format.h>

#include "osteomill/base/distribution.h"

namespace osteomill {

namespace {

// Returns twice the ranks of the magnitudes, so that mean ranks are integers.
std::vector<std::size_t> doubled_ranks(const std::vector<double>& sizes) {
  std::vector<std::size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return sizes[a] < sizes[b]; });
  std::vector<std::size_t> ranks(sizes.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last + 1 < order.size() && sizes[order[last + 1]] == sizes[order[first]]) ++last;
    for (std::size_t n = first; n <= last; ++n) ranks[order[n]] = first + last + 2;
    first = last + 1;
  }
  return ranks;
}

// Returns the probability that the sum of a random subset of the ranks is at most `sum`.
double chance_of_at_most(const std::vector<std::size_t>& ranks, std::size_t sum) {
  std::vector<double> chance(sum + 1, 0.0);
  chance[0] = 1;
  for (const std::size_t rank : ranks) {
    for (std::size_t s = sum + 1; s-- > 0;) {
      chance[s] = 0.5 * (chance[s] + (s >= rank ? chance[s - rank] : 0.0));
    }
  }
  return std::accumulate(chance.begin(), chance.end(), 0.0);
}

}  // namespace

SignedRank signed_rank(std::span<const double> differences) {
  std::vector<double> sizes;
  std::vector<bool> above;
  for (const double difference : differences) {
    if (difference == 0) continue;
    sizes.push_back(std::abs(difference));
    above.push_back(difference > 0);
  }
  SignedRank test;
  test.pairs = sizes.size();
  if (sizes.empty()) return test;
  const std::vector<std::size_t> ranks = doubled_ranks(sizes);
  std::size_t positive = 0;
  std::size_t negative = 0;
  for (std::size_t n = 0; n < ranks.size(); ++n) (above[n] ? positive : negative) += ranks[n];
  test.positive = 0.5 * static_cast<double>(positive);
  test.negative = 0.5 * static_cast<double>(negative);
  test.p = std::min(1.0, 2 * chance_of_at_most(ranks, std::min(positive, negative)));
  return test;
}

std::string p_text(double p) {
  return p < 0.001 ? "p < 0.001" : fmt::format("p = {:.2g}", p);
}

double min_p(std::size_t differences) {
  return differences == 0 ? 1.0 : std::ldexp(2.0, -static_cast<int>(differences));
}

std::vector<double> holm_corrected(std::span<const double> p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> corrected(p.size());
  double min = 0;
  for (std::size_t n = 0; n < order.size(); ++n) {
    const double times = static_cast<double>(order.size() - n);
    min = std::max(min, std::min(1.0, times * p[order[n]]));
    corrected[order[n]] = min;
  }
  return corrected;
}

double chance_of_fewer_heads(std::size_t k, std::size_t tosses) {
  double exactly = std::ldexp(1.0, -static_cast<int>(tosses));
  double fewer = 0;
  for (std::size_t m = 0; m < k; ++m) {
    fewer += exactly;
    exactly *= static_cast<double>(tosses - m) / static_cast<double>(m + 1);
  }
  return fewer;
}

MedianInterval median_interval(std::span<const double> values, double coverage) {
  if (values.empty()) return {};
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  const auto coverage_of = [&](std::size_t k) { return 1 - 2 * chance_of_fewer_heads(k, n); };
  const bool is_range = coverage_of(1) < coverage;
  std::size_t k = 1;
  while (!is_range && 2 * (k + 1) <= n && coverage_of(k + 1) >= coverage) ++k;
  return {distribution_of(sorted).median, sorted[k - 1], sorted[n - k], std::max(0.0, coverage_of(k)),
          is_range};
}

}  // namespace osteomill
