#include "benchmarks/percentiles.h"

#include "osteomill/numbers/distribution.h"

namespace osteomill::benchmarks {

void TickTimes::report(benchmark::State& state, const std::string& prefix) const {
  if (times_us_.empty()) return;
  const Distribution times = distribution_of(times_us_);
  state.counters[prefix + "p50_us"] = times.median;
  state.counters[prefix + "p99_us"] = times.p99;
  state.counters[prefix + "max_us"] = times.max;
}

}  // namespace osteomill::benchmarks
