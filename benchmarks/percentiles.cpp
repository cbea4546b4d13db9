#include "benchmarks/percentiles.h"

#include <thread>

#include "osteomill/base/distribution.h"

namespace osteomill::benchmarks {

namespace {

void rest_now_and_then() {
  using namespace std::chrono_literals;
  static auto last = std::chrono::steady_clock::time_point{};
  const auto awake = std::chrono::steady_clock::now() - last;
  if (awake < 20ms) return;
  // Work before the measurement may have used up the thread's real-time budget of this second.
  std::this_thread::sleep_for(awake > 500ms ? 100ms : 2ms);
  last = std::chrono::steady_clock::now();
}

}  // namespace

void TickTimes::add(double microseconds) {
  times_us_.push_back(microseconds);
  rest_now_and_then();
}

void TickTimes::report(benchmark::State& state, const std::string& prefix) const {
  if (times_us_.empty()) return;
  const Distribution times = distribution_of(times_us_);
  state.counters[prefix + "p50_us"] = times.median;
  state.counters[prefix + "p99_us"] = times.p99;
  state.counters[prefix + "max_us"] = times.max;
}

}  // namespace osteomill::benchmarks
