#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "osteomill/base/distribution.h"
#include "osteomill/session/milling_entry.h"
#include "osteomill/study/metrics.h"
#include "osteomill/study/milling_trial.h"
#include "osteomill/volume/bone_densities.h"
#include "osteomill/volume/builtin_tooth.h"

#include "tests/own_memory.h"
#include "tests/shapes.h"
#include "verification/sections.h"

namespace osteomill::verification {

namespace {

constexpr double kForceWithin = 0.03;
constexpr double kMaxTick_us = 1000;
// Runs of each trial. The machine may stall for milliseconds, but hardly in the same tick of every run.
constexpr int kRuns = 3;
constexpr double kCoarse_mm = 0.125, kFine_mm = 0.03125;

// Returns a block of bone within a margin; `size_mm` includes the margin.
Volume block(double spacing_mm, const Vec3& size_mm) {
  constexpr double kMargin_mm = 0.375, kEdge_mm = 0.25;
  GridGeometry geometry;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    geometry.dims[axis] =
        static_cast<int>(std::lround(size_mm[static_cast<Eigen::Index>(axis)] / spacing_mm));
  }
  geometry.spacing_mm = Vec3::Constant(spacing_mm);
  geometry.origin_mm = Vec3::Constant(0.5 * spacing_mm);
  const Vec3 middle_W = 0.5 * size_mm;
  return testing_support::shape_volume(
      geometry, [&](const Vec3& p) { return ((p - middle_W).cwiseAbs() - middle_W).maxCoeff() + kMargin_mm; },
      kEdge_mm / spacing_mm);
}
// 440 x 440 x 300 fine voxels.
const Vec3 kBlock_mm(13.75, 13.75, 9.375);

struct Figures {
  RunMetrics milling, holding;
  Distribution milling_us;
  int faults = 0;
  double memory_MiB = 0;
};

struct Phases {
  Recording milling, holding;
  double memory_MiB = 0;
};

Phases run_trial(const Volume& bone, double phase_s, TrialSettings settings) {
  settings.hand_and_device.seed = 11;
  settings.hand_and_device.script.milling_s = phase_s;
  settings.hand_and_device.script.holding_s = 0.5 * phase_s;
  const double before_MiB = testing_support::own_memory_MiB();
  MillingTrial trial(bone, estimate_densities(bone), place_entry(bone, settings.tool), settings);
  Phases phases;
  while (!trial.finished()) {
    const MillingTrial::Tick tick = trial.tick();
    (tick.milling_phase ? phases.milling : phases.holding).records.push_back(tick.record);
  }
  phases.memory_MiB = testing_support::own_memory_MiB() - before_MiB;
  return phases;
}

// Replaces each tick's times by those of the same tick in another run if they are lower.
void keep_lower_times(std::vector<TickRecord>& records, const std::vector<TickRecord>& others) {
  for (std::size_t n = 0; n < records.size(); ++n) {
    for (const auto time_us : {&TickRecord::compute_us, &TickRecord::milling_us, &TickRecord::tick_cpu_us}) {
      records[n].*time_us = std::min(records[n].*time_us, others.at(n).*time_us);
    }
  }
}

// Runs a trial `runs` times; each tick gets the lowest times of all runs.
Phases run_trials(const Volume& bone, double phase_s, int runs, const TrialSettings& settings) {
  Phases phases = run_trial(bone, phase_s, settings);
  for (int run = 1; run < runs; ++run) {
    const Phases again = run_trial(bone, phase_s, settings);
    keep_lower_times(phases.milling.records, again.milling.records);
    keep_lower_times(phases.holding.records, again.holding.records);
  }
  return phases;
}

Figures figures_of(const Volume& bone, double phase_s, int runs) {
  TrialSettings settings;
  settings.hand_and_device.script.until_leant = true;
  const Phases phases = run_trials(bone, phase_s, runs, settings);
  Figures figures;
  figures.memory_MiB = phases.memory_MiB;
  figures.milling = run_metrics(phases.milling);
  figures.holding = run_metrics(phases.holding);
  std::vector<double> milling_us;
  for (const TickRecord& record : phases.milling.records) milling_us.push_back(record.milling_us);
  figures.milling_us = distribution_of(milling_us);
  for (const Recording* phase : {&phases.milling, &phases.holding}) {
    figures.faults += static_cast<int>(std::ranges::count_if(
        phase->records, [](const TickRecord& record) { return record.fault != WrenchFault::none; }));
  }
  return figures;
}

std::string with_difference(double fine, double coarse) {
  return fmt::format("{} ({:+.1f} %)", figure(fine), 100 * (fine / coarse - 1));
}

void add_row(Section& section, const std::string& bone, const Figures& fine, const Figures& coarse) {
  const auto alike = [](const VectorMetrics& a, const VectorMetrics& b) {
    return std::abs(a.mean / b.mean - 1) <= kForceWithin;
  };
  const double tick_us = std::max(fine.milling.tick_us.max, fine.holding.tick_us.max);
  section.add({bone, with_difference(fine.milling.force_N.mean, coarse.milling.force_N.mean),
               with_difference(fine.holding.force_N.mean, coarse.holding.force_N.mean),
               figure(fine.milling.force_N.step_max), figure(fine.milling.torque_Nmm.step_max),
               fmt::format("{}", fine.faults), figure(fine.milling.step_us.p99), figure(fine.milling_us.p99),
               figure(tick_us), fmt::format("{:.0f}", fine.memory_MiB)},
              alike(fine.milling.force_N, coarse.milling.force_N) &&
                  alike(fine.holding.force_N, coarse.holding.force_N) && fine.faults == 0 &&
                  tick_us <= kMaxTick_us);
}

void add_rows(Section& section, const std::string& name, const Volume& fine, const Volume& coarse,
              double phase_s) {
  add_row(section, name, figures_of(fine, phase_s, kRuns), figures_of(coarse, phase_s, 1));
}

}  // namespace

Section fine_scans(const Effort& effort) {
  const double phase_s = 0.5 * effort.phase_s;
  Section section{
      "Voxels of 0.031 mm",
      fmt::format(
          "Must hold: the mean force while milling and while holding equals that at {} mm within {:g} "
          "%, every wrench is finite, and no tick takes over {:g} us of CPU time. A block of 440 x 440 "
          "x 300 voxels, and the built-in tooth of 1024 x 1024 x 704, milled for {:g} s (longer until "
          "the shaft has leant) and held, push 1.5 N, seed 11, one trial at a time; a tick's times are "
          "the minimum over {} runs of the same trial. In brackets: relative to {} mm. Memory: the "
          "trial's memory in addition to the scan, including the pages that milling copied.",
          kCoarse_mm, 100 * kForceWithin, kMaxTick_us, phase_s, kRuns, kCoarse_mm),
      {"bone", "force milling, N", "force holding, N", "force step, N", "torque step, N mm", "faults",
       "step p99, us", "milling p99, us", "longest tick, us CPU", "memory, MiB", ""},
      {},
      {}};
  add_rows(section, "block", block(kFine_mm, kBlock_mm), block(kCoarse_mm, kBlock_mm), phase_s);
  add_rows(section, "tooth", Volume(builtin_tooth(kCoarse_mm / kFine_mm), kBuiltinToothIsovalue),
           Volume(builtin_tooth(), kBuiltinToothIsovalue), phase_s);
  return section;
}

Section time_of_a_tick(const Effort& effort) {
  const double phase_s = 0.2 * effort.phase_s;
  constexpr double kMost_us = 500, kEver_us = 800;
  const Vec3 size_mm(16, 16, 8);
  Section section{
      "What a tick takes, whatever the burr and the voxels",
      fmt::format(
          "Must hold: 99.9 % of the ticks take at most {:g} us of CPU time, and none over {:g}. A block "
          "of {:g} x {:g} x {:g} mm, milled for {:g} s with a push of 1.5 N per millimetre of the "
          "burr's radius (at least 1.5 N) and held for half as long, seed 11, one trial at a time; a "
          "tick's time is the minimum over {} runs of the same trial. Owed: pending bricks, whose "
          "points a tick leaves to later ticks.",
          kMost_us, kEver_us, size_mm.x(), size_mm.y(), size_mm.z(), phase_s, kRuns),
      {"burr, voxels", "median, us", "99.9 %, us", "longest, us", "owed, median", "owed, most", ""},
      {},
      {}};
  for (const double spacing_mm : {0.5, 0.25, 0.125, 0.0625, kFine_mm}) {
    const Volume bone = block(spacing_mm, size_mm);
    // Burrs over 150 voxels are not supported.
    for (const double burr_radius_mm : {0.5, 1.5, 3.0, std::min(6.0, 144 * spacing_mm)}) {
      TrialSettings settings;
      settings.tool = {burr_radius_mm, std::min(1.0, burr_radius_mm), 25};
      settings.hand_and_device.hand.push_N = 1.5 * std::max(1.0, burr_radius_mm);
      const Phases phases = run_trials(bone, phase_s, kRuns, settings);
      std::vector<double> busy_us, owed;
      for (const Recording* phase : {&phases.milling, &phases.holding}) {
        for (const TickRecord& record : phase->records) {
          busy_us.push_back(record.busy_us());
          owed.push_back(record.pending_bricks);
        }
      }
      const double longest_us = std::ranges::max(busy_us);
      const double most_us = percentile(busy_us, 0.999);
      section.add({fmt::format("{} mm, {:.3g} mm", burr_radius_mm, spacing_mm),
                   figure(percentile(busy_us, 0.5)), figure(most_us), figure(longest_us),
                   figure(percentile(owed, 0.5)), figure(std::ranges::max(owed))},
                  most_us <= kMost_us && longest_us <= kEver_us);
    }
  }
  return section;
}

}  // namespace osteomill::verification
