#pragma once

#include <chrono>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

namespace osteomill::benchmarks {

/// Times of single ticks. Reports percentiles, because a hand feels the slowest ticks and not the mean.
class TickTimes {
 public:
  /// Sleeps occasionally, because the kernel stops a real-time thread that never sleeps for 50 ms per second.
  void add(double microseconds);
  /// Times `f()`, adds the time and returns it, in microseconds.
  template <typename F>
  double time(F&& f) {
    const auto start = std::chrono::steady_clock::now();
    f();
    add(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
    return times_us_.back();
  }
  /// Adds the counters `<prefix>p50_us`, `<prefix>p99_us` and `<prefix>max_us`.
  void report(benchmark::State& state, const std::string& prefix = "") const;

 private:
  std::vector<double> times_us_;
};

}  // namespace osteomill::benchmarks
