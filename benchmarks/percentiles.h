#pragma once

#include <chrono>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

namespace osteomill::benchmarks {

/// Times of single ticks, of which a mean says little: what a hand feels is the slow one.
class TickTimes {
 public:
  /// Sleeps now and then: the kernel takes 50 ms of a second from a real-time thread that never does.
  void add(double microseconds);
  /// Times `f()`, takes it in and returns it, in microseconds.
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
