#include "osteomill/live/time_histogram.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "osteomill/numbers/distribution.h"

namespace osteomill {

namespace {

// One thread alone adds, so that no locked instruction is needed.
template <typename T>
void increment(std::atomic<T>& counter) {
  counter.store(counter.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

}  // namespace

void TimeHistogram::add(double time_us) {
  increment(bins_[bin_of(time_us)]);
  increment(count_);
  if (time_us > max_us_.load(std::memory_order_relaxed)) {
    max_us_.store(time_us, std::memory_order_relaxed);
  }
}

std::size_t TimeHistogram::bin_of(double time_us) {
  if (!(time_us > 0)) return 0;
  if (time_us < 1e3) return static_cast<std::size_t>(time_us);
  if (time_us < 1e4) return kFineBins + static_cast<std::size_t>((time_us - 1e3) / 10);
  return kBins - 1;
}

double TimeHistogram::upper_end_us(std::size_t bin) {
  if (bin < kFineBins) return static_cast<double>(bin + 1);
  if (bin + 1 < kBins) return 1e3 + 10 * static_cast<double>(bin - kFineBins + 1);
  return std::numeric_limits<double>::infinity();
}

TimePercentiles TimeHistogram::percentiles() const {
  std::array<std::uint32_t, kBins> counts;
  std::uint64_t total = 0;
  for (std::size_t n = 0; n < kBins; ++n) total += counts[n] = bins_[n].load(std::memory_order_relaxed);
  TimePercentiles found;
  if (total == 0) return found;
  found.max_us = max_us_.load(std::memory_order_relaxed);
  const auto of_rank = [&](std::uint64_t rank) {
    std::uint64_t passed = 0;
    std::size_t bin = 0;
    while (bin + 1 < kBins && (passed += counts[bin]) < rank) ++bin;
    return std::min(upper_end_us(bin), found.max_us);
  };
  const auto at_share = [&](double share) {
    const auto [lower, upper] = percentile_ranks(share, total);
    return 0.5 * (of_rank(lower) + of_rank(upper));
  };
  found.p50_us = at_share(0.5);
  found.p99_us = at_share(0.99);
  found.p999_us = at_share(0.999);
  return found;
}

}  // namespace osteomill
