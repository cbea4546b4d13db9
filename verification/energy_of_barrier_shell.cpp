#include <fmt/core.h>

#include "verification/sections.h"
#include "verification/trial_figures.h"

namespace osteomill::verification {

namespace {

constexpr double kHalfAnHour_s = 1800;

struct Run {
  std::string name;
  const Volume* bone;
  TrialVariant variant;
};

std::vector<Run> runs(const Bones& bones, const Effort& effort) {
  const TrialVariant usual{.algorithm = "barrier-shell", .seed = 11, .phase_s = effort.phase_s};
  std::vector<Run> all{{bones.tooth_name + ", 1.5 N", &bones.tooth, usual},
                       {bones.tooth_name + ", 3 N", &bones.tooth, usual},
                       {bones.tooth_name + ", 1.5 N, half an hour", &bones.tooth, usual}};
  all[1].variant.push_N = 3;
  all[2].variant.phase_s = effort.phase_s < 20 ? effort.phase_s : kHalfAnHour_s;
  if (bones.second) all.push_back({bones.second_name + ", 3 N", &*bones.second, all[1].variant});
  return all;
}

}  // namespace

Section energy_of_barrier_shell(const Bones& bones, const Effort& effort) {
  Section section{
      "Stored energy of barrier-shell",
      "Must hold: the stored energy falls in every tick, also while bone is removed, except for the "
      "increase from new points, whose areas differ slightly from those of the old ones: at most "
      "0.001 N mm in a tick, and in total a thousandth of the work that the burr's force pays for. "
      "A rise is measured at the start of a tick, at the poses of tool and device at the end of the "
      "previous tick. A pass of the solver is one sum over the points; an unfinished tick ends at "
      "the best certified pose.",
      {"bone, push", "ticks with a rise", "risen in all, N mm", "at worst in a tick, N mm", "passes a tick",
       "unfinished ticks", "nearest to a core, share of the skin", "force mean, N", "removed, mm3", ""},
      {},
      {}};
  for (const Run& run : runs(bones, effort)) {
    const TrialFigures figures = milling_figures(*run.bone, run.variant);
    const barrier_shell::Counts& c = *figures.counts;
    const auto share = [&](std::uint64_t count) {
      return fmt::format("{:.2g} %", 100 * static_cast<double>(count) / static_cast<double>(c.ticks));
    };
    const double work_Nmm = figures.metrics.removed_mm3 * CuttingSettings{}.specific_energy_Nmm_per_mm3;
    section.add(
        {run.name, share(c.energy_rises), figure(c.energy_risen_Nmm), figure(c.worst_rise_Nmm),
         figure(static_cast<double>(c.passes) / static_cast<double>(c.ticks)), share(c.unfinished),
         figure(c.min_distance_share), figure(figures.metrics.force_N.mean),
         figure(figures.metrics.removed_mm3)},
        c.worst_rise_Nmm <= 0.001 && c.energy_risen_Nmm <= 1e-3 * work_Nmm && c.min_distance_share > 0);
  }
  return section;
}

}  // namespace osteomill::verification
