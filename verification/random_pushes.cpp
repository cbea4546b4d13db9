#include <algorithm>

#include "verification/pushes.h"
#include "verification/sections.h"
#include <fmt/core.h>

#include "osteomill/haptics/algorithms.h"

namespace osteomill::verification {

namespace {

constexpr double kDeepest_mm = 0.3;
// The shaft lies with its middle in the surface: whatever is deeper is through.
constexpr double kThrough_mm = 0.99;

// How many of 10,000 pushes may end deeper, by what is felt.
double allowed_in_10000(std::string_view id) {
  if (id == "line-proxy") return 5;
  return id == "surface-points" ? 1 : 0;
}

// "end deeper / ever deeper / through at the end".
std::string counts(const std::vector<PushOutcome>& all, Depth PushOutcome::*depths) {
  return fmt::format("{} / {} / {}", count_deeper(all, depths, &Depth::at_end_mm, kDeepest_mm),
                     count_deeper(all, depths, &Depth::ever_mm, kDeepest_mm),
                     count_deeper(all, depths, &Depth::at_end_mm, kThrough_mm));
}

}  // namespace

Section random_pushes(const Bones& bones, const Effort& effort) {
  Section section{
      "Pushes from anywhere",
      fmt::format(
          "Must hold: what is felt ends more than {} mm past the surface in at most 5 of 10,000 pushes "
          "for 1, 1 for 2, none for 3, and that of 4 is never there. {} pushes of 2 to 10 N at 20 to "
          "300 mm/s against {}, burr or shaft first, from any side and in any pose, looked at every "
          "{} ms independently of the algorithms. What is felt is the tool at the pose that the "
          "wrench holds it at (1: its centreline, which is what 1 collides); what is drawn is shown "
          "as its centreline and as the tool with its radii. Each as pushes that end deeper / ever "
          "are deeper / end through (deeper than {} mm, the shaft's radius).",
          kDeepest_mm, effort.pushes, bones.tooth_name, kTicksBetweenLooks, kThrough_mm),
      {"algorithm", "felt", "drawn centreline", "drawn tool", "felt at the end: median, mm", "99.9 %, mm",
       "deepest, mm", ""},
      {},
      {}};
  const BoneSurface surface(bones.tooth);
  for (const std::string& id : algorithm_names()) {
    const std::vector<PushOutcome> all = push_outcomes(id, bones.tooth, surface, {}, effort.pushes);
    std::vector<double> at_end;
    for (const PushOutcome& outcome : all) at_end.push_back(outcome.felt.at_end_mm);
    const auto deeper =
        static_cast<double>(count_deeper(all, &PushOutcome::felt, &Depth::at_end_mm, kDeepest_mm));
    const std::size_t ever = count_deeper(all, &PushOutcome::felt, &Depth::ever_mm, kDeepest_mm);
    section.add({id, counts(all, &PushOutcome::felt), counts(all, &PushOutcome::drawn_centreline),
                 counts(all, &PushOutcome::drawn_tool), figure(distribution_of(at_end).median),
                 figure(percentile(at_end, 0.999)), figure(percentile(at_end, 1))},
                deeper <= allowed_in_10000(id) * std::max(1.0, effort.pushes / 1e4) &&
                    (id != "barrier-shell" || ever == 0));
  }
  return section;
}

}  // namespace osteomill::verification
