#include "benchmarks/percentiles.h"

#include <algorithm>
#include <cmath>

namespace osteomill::benchmarks {

void TickTimes::report(benchmark::State& state, const std::string& prefix) const {
  if (times_us_.empty()) return;
  std::vector<double> sorted = times_us_;
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](double share) {
    return sorted[static_cast<std::size_t>(std::lround(share * static_cast<double>(sorted.size() - 1)))];
  };
  state.counters[prefix + "p50_us"] = at(0.5);
  state.counters[prefix + "p99_us"] = at(0.99);
  state.counters[prefix + "max_us"] = sorted.back();
}

}  // namespace osteomill::benchmarks
