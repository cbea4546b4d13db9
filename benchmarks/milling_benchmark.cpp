// Removing bone and updating the shell: a burr is pressed into flat bone with constant force until it has
// sunk in beyond its equator.

#include <string>

#include <benchmark/benchmark.h>

#include "osteomill/milling/burr_mill.h"

#include "barrier_shell/barrier_shell.h"
#include "benchmarks/percentiles.h"
#include "tests/shapes.h"

namespace osteomill::benchmarks {

namespace {

constexpr double kForce_N = 4;
constexpr double kTick_s = 1e-3;

Volume flat_bone(double spacing_mm, double burr_radius_mm) {
  const int voxels = static_cast<int>(4 * burr_radius_mm / spacing_mm);
  return testing_support::shape_volume(testing_support::centred_cube(voxels, spacing_mm),
                                       testing_support::plane({0, 0, 0.5 * burr_radius_mm}, Vec3::UnitZ()));
}

void mill(benchmark::State& state, double burr_radius_mm, double spacing_mm) {
  const MillingTool tool{burr_radius_mm, 1.0, 25.0};
  const Volume bone = flat_bone(spacing_mm, burr_radius_mm);
  for ([[maybe_unused]] auto _ : state) {
    Volume volume = bone;
    barrier_shell::BarrierShell algorithm(barrier_shell::Settings{});
    algorithm.prepare({&volume, tool});
    BurrMill burr(volume, burr_radius_mm, {0, 1000}, {});
    TickTimes both, cutting, refreshing, steps;
    double removed_mm3 = 0, pressed_mm3 = 0;
    // The hand's target sinks while the spring force is below the target force.
    Pose X_WD{{0, 0, 1.5 * burr_radius_mm}, Quat::Identity()};
    int ticks = 0;
    for (; ticks < 12000; ++ticks) {
      HapticStep step;
      steps.time([&] { step = algorithm.step(X_WD, kTick_s); });
      const double pushed_N = step.wrench.force_N.z();
      X_WD.position_mm.z() -= std::clamp(0.0005 * (kForce_N - pushed_N), -0.002, 0.002);
      X_WD.position_mm.x() = 0.02 * std::sin(0.05 * ticks);
      if (step.contacts == 0) continue;
      MillingStep done;
      const double cut_us =
          cutting.time([&] { done = burr.step(step.X_WT.position_mm, step.burr_force_W_N, kTick_s); });
      const double refresh_us = refreshing.time([&] {
        if (!done.change.voxels.empty()) algorithm.volume_changed(done.change);
      });
      both.add(cut_us + refresh_us);
      removed_mm3 += done.removed_mm3;
      pressed_mm3 += MillingSettings{}.removal_rate_mm3_per_Ns * step.burr_force_W_N.norm() * kTick_s;
      if (step.X_WT.position_mm.z() < -0.5 * burr_radius_mm) break;
    }
    both.report(state);
    cutting.report(state, "cut_");
    refreshing.report(state, "refresh_");
    steps.report(state, "step_");
    state.counters["removed_share"] = removed_mm3 / pressed_mm3;
    state.counters["removed_mm3"] = removed_mm3;
    state.counters["ticks"] = ticks;
    state.counters["shell_points"] = algorithm.sample_point_count();
  }
}

// Registers scans with 256, 512 and 1024 voxels along a tooth.
const bool kAdded = [] {
  struct Case {
    const char* name;
    double burr_radius_mm, spacing_mm;
  };
  for (const Case& c : {Case{"1.5mm/0.125mm", 1.5, 0.125},
                        {"1.5mm/0.0625mm", 1.5, 0.0625},
                        {"1.5mm/0.031mm", 1.5, 0.03125},
                        {"3.0mm/0.125mm", 3, 0.125},
                        {"3.0mm/0.0625mm", 3, 0.0625},
                        {"3.0mm/0.031mm", 3, 0.03125}}) {
    benchmark::RegisterBenchmark(("milling/burr_" + std::string(c.name)).c_str(), mill, c.burr_radius_mm,
                                 c.spacing_mm)
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace

}  // namespace osteomill::benchmarks
