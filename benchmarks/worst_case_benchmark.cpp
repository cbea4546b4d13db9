// Each algorithm's step when most of the tool touches: its whole shaft sleeved in a hole that fits it, in a
// block of 512 x 512 x 352 voxels.

#include <string>

#include <benchmark/benchmark.h>

#include "osteomill/haptics/algorithms.h"

#include "benchmarks/bones.h"
#include "benchmarks/percentiles.h"

namespace osteomill::benchmarks {

namespace {

constexpr double kOverlap_mm = 0.03;
constexpr int kTicks = 400;

// Stirs by a few hundredths of a millimetre, so that each step has something to solve.
Pose stirred(const Pose& pose, int tick) {
  const double t = 0.02 * tick;
  return {pose.position_mm + 0.02 * Vec3(std::sin(t), std::cos(1.3 * t), std::sin(1.7 * t)),
          pose.orientation};
}

void sleeved(benchmark::State& state, std::string_view algorithm, double spacing_mm) {
  const MillingTool tool;
  const Volume block = sleeve_block(spacing_mm, tool, kOverlap_mm);
  const Pose pose = pose_in_sleeve(block, tool);
  const auto haptics = make_algorithm(algorithm_named(algorithm), {});
  haptics->prepare({&block, tool});
  for ([[maybe_unused]] auto _ : state) {
    haptics->reset();
    TickTimes steps;
    int contacts = 0;
    for (int n = 0; n < kTicks; ++n) {
      steps.time([&] { contacts = haptics->step(stirred(pose, n), 1e-3).contacts; });
    }
    steps.report(state);
    state.counters["contacts"] = contacts;
    state.counters["sample_points"] = haptics->sample_point_count();
  }
}

const bool kAdded = [] {
  for (const double spacing_mm : {0.125, 0.0625}) {
    const std::string voxels = spacing_mm > 0.1 ? "/0.125mm" : "/0.0625mm";
    for (const std::string& algorithm : algorithm_names()) {
      benchmark::RegisterBenchmark(("sleeved/" + algorithm + voxels).c_str(), sleeved, algorithm, spacing_mm)
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
    }
  }
  return true;
}();

}  // namespace

}  // namespace osteomill::benchmarks
