// Step time of each algorithm in closed loop: a simulated hand mills a hole (or presses and leans, with the
// spindle off), and every tick is timed. Percentiles cover only ticks in contact with bone.

#include <string>

#include <benchmark/benchmark.h>

#include "osteomill/study/milling_trial.h"
#include "osteomill/volume/bone_densities.h"

#include "benchmarks/bones.h"
#include "benchmarks/percentiles.h"

namespace osteomill::benchmarks {

namespace {

struct Trial {
  std::string_view algorithm;
  Bone bone;
  bool milling;
  /// The algorithm's resolution setting (vertices, slices, shell scale); 0: default.
  int resolution = 0;
};

TrialSettings settings_of(const Trial& trial) {
  TrialSettings settings;
  settings.algorithm = algorithm_named(trial.algorithm);
  settings.spindle = trial.milling;
  settings.hand_and_device.script.milling_s = 5;
  settings.hand_and_device.script.holding_s = 1;
  settings.hand_and_device.script.settle_s = 0.5;
  if (trial.resolution > 0) {
    const AlgorithmDescription& chosen = algorithm_named(trial.algorithm);
    settings.haptics.named.push_back(
        {chosen.id.name, chosen.resolution_setting, static_cast<double>(trial.resolution)});
  }
  return settings;
}

void closed_loop(benchmark::State& state, const Trial& trial) {
  const Volume& bone = bone_volume(trial.bone);
  const TrialSettings settings = settings_of(trial);
  const MillingEntry entry = place_entry(bone, settings.tool);
  const BoneDensities densities = estimate_densities(bone);
  for ([[maybe_unused]] auto _ : state) {
    MillingTrial run(bone, densities, entry, settings);
    TickTimes steps, milling;
    double removed_mm3 = 0, contacts = 0;
    while (!run.finished()) {
      const MillingTrial::Tick tick = run.tick();
      if (tick.record.contacts == 0) continue;
      steps.add(tick.record.compute_us);
      if (trial.milling && tick.milling_phase) milling.add(tick.record.milling_us);
      contacts = std::max(contacts, static_cast<double>(tick.record.contacts));
      removed_mm3 = tick.record.removed_mm3;
    }
    steps.report(state);
    milling.report(state, "milling_");
    state.counters["sample_points"] = run.algorithm().sample_point_count();
    state.counters["most_contacts"] = contacts;
    state.counters["removed_mm3"] = removed_mm3;
  }
}

std::string name(const Trial& trial) {
  std::string text = "closed_loop/" + std::string(trial.algorithm) + "/" + name_of(trial.bone) +
                     (trial.milling ? "/milling" : "/spindle_off");
  if (trial.resolution > 0) text += "/resolution:" + std::to_string(trial.resolution);
  return text;
}

void add(const Trial& trial) {
  if (!is_available(trial.bone)) return;
  benchmark::RegisterBenchmark(name(trial).c_str(), closed_loop, trial)
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

const bool kAdded = [] {
  for (const std::string& algorithm : algorithm_names()) {
    for (const Bone bone :
         {Bone::builtin, Bone::builtin_refined, Bone::real_tooth, Bone::real_tooth_refined}) {
      for (const bool milling : {true, false}) add({algorithm, bone, milling});
    }
    add({algorithm, Bone::builtin_finest, true});
  }
  for (const int vertices : {101, 1001}) add({"line-proxy", Bone::builtin, true, vertices});
  for (const int slices : {10, 100}) add({"surface-points", Bone::builtin, true, slices});
  for (const int scale : {2, 3}) add({"point-shell", Bone::builtin, true, scale});
  return true;
}();

}  // namespace

}  // namespace osteomill::benchmarks
