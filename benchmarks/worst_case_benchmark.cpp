// Each algorithm's step where most of the tool touches: its whole shaft sleeved in a hole that fits it, in a
// block of 512 x 512 x 352 voxels.

#include <string>

#include "benchmarks/bones.h"
#include "benchmarks/percentiles.h"
#include <benchmark/benchmark.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/haptics/point_shell/contacts.h"
#include "osteomill/haptics/point_shell/point_shell_description.h"

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
  const auto haptics = make_algorithm(algorithm, HapticSettings{});
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

// One look for contacts, without the rest of the step.
void sleeved_contacts(benchmark::State& state, double spacing_mm) {
  const MillingTool tool;
  const Volume block = sleeve_block(spacing_mm, tool, kOverlap_mm);
  const Pose pose = pose_in_sleeve(block, tool);
  BoneBricks bricks(block, BoneBricks::kSpacing_mm, BoneBricks::Points::fine);
  const point_shell::Settings settings = point_shell::Settings::defaults(Mode::steady);
  NearBone near(65536, NearBone::PointsMeet::the_nearest_part);
  const Penalty penalty{contact_stiffness_N_per_mm3(settings, tool), 2 * bricks.lattice().cell_area_mm2()};
  int touching = 0;
  for ([[maybe_unused]] auto _ : state) {
    TickTimes looks;
    for (int n = 0; n < kTicks; ++n) {
      looks.time([&] {
        touching =
            point_shell::contacts_by_bricks(bricks, near, tool, stirred(pose, n), penalty).total().touching;
      });
    }
    looks.report(state);
  }
  state.counters["contacts"] = touching;
  state.counters["sample_points"] = static_cast<double>(bricks.fine().total());
}

const bool kAdded = [] {
  for (const double spacing_mm : {0.125, 0.0625}) {
    const std::string voxels = spacing_mm > 0.1 ? "/0.125mm" : "/0.0625mm";
    for (const std::string& algorithm : algorithm_names()) {
      benchmark::RegisterBenchmark(("sleeved/" + algorithm + voxels).c_str(), sleeved, algorithm, spacing_mm)
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
    }
    benchmark::RegisterBenchmark(("sleeved_contacts/point-shell" + voxels).c_str(), sleeved_contacts,
                                 spacing_mm)
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace

}  // namespace osteomill::benchmarks
