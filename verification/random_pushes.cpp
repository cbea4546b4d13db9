#include <algorithm>

#include <fmt/core.h>

#include "osteomill/haptics/algorithms.h"

#include "verification/pushes.h"
#include "verification/sections.h"

namespace osteomill::verification {

namespace {

constexpr double kDeepest_mm = 0.3;
// At this depth the shaft's axis is in the surface; deeper counts as through.
constexpr double kThrough_mm = 0.99;

// Returns "end deeper / ever deeper / through at the end".
std::string counts(const std::vector<PushOutcome>& all, Depth PushOutcome::*depths) {
  return fmt::format("{} / {} / {}", count_deeper(all, depths, &Depth::final_mm, kDeepest_mm),
                     count_deeper(all, depths, &Depth::max_mm, kDeepest_mm),
                     count_deeper(all, depths, &Depth::final_mm, kThrough_mm));
}

}  // namespace

Section random_pushes(const Bones& bones, const Effort& effort) {
  Section section{
      "Random pushes",
      fmt::format(
          "Must hold for 4: the simulated tool is never more than {} mm past the surface. {} pushes of "
          "2 to 10 N at 20 to 300 mm/s against {}, burr or shaft first, from any side and in any pose, "
          "checked every {} ms independently of the algorithms, with the tool's radii and as its "
          "centreline. Each cell has the number of pushes that end deeper / are ever deeper / end "
          "through (deeper than {} mm, the shaft's radius).",
          kDeepest_mm, effort.pushes, bones.tooth_name, kTicksBetweenChecks, kThrough_mm),
      {"algorithm", "tool", "centreline", "tool at the end: median, mm", "99.9 %, mm", "deepest, mm", ""},
      {},
      {}};
  const BoneSurface surface(bones.tooth);
  for (const std::string& id : algorithm_names()) {
    const std::vector<PushOutcome> all = push_outcomes(id, bones.tooth, surface, {}, effort.pushes);
    std::vector<double> at_end;
    for (const PushOutcome& outcome : all) at_end.push_back(outcome.tool.final_mm);
    section.add_of(id,
                   {id, counts(all, &PushOutcome::tool), counts(all, &PushOutcome::centreline),
                    figure(distribution_of(at_end).median), figure(percentile(at_end, 0.999)),
                    figure(percentile(at_end, 1))},
                   count_deeper(all, &PushOutcome::tool, &Depth::max_mm, kDeepest_mm) == 0);
  }
  return section;
}

}  // namespace osteomill::verification
