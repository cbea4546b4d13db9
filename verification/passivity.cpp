#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/study/measure_passivity.h"
#include "osteomill/study/probe_bones.h"

#include "verification/in_parallel.h"
#include "verification/sections.h"

namespace osteomill::verification {

Section passivity() {
  Section section{
      "Largest passive stiffness",
      "Must hold for 4: the largest felt stiffness at which the motion dies out is `2 b / (T + 2 "
      "tau)` within 5 % on every device. A handle of 0.3 kg, pressed with 0.5 N on a flat wall at "
      "1000 Hz, is released with a swing; devices with 1, 2, 5 and 10 N s/m of damping and 0.3, 1 "
      "and 2 ms of delay. Ratio of felt stiffness to the rule's: smallest, median and largest over "
      "the devices; then the number of devices without any passive stiffness, and of those with "
      "only passive ones.",
      {"algorithm", "least", "median", "greatest", "none passive", "all passive", ""},
      {},
      {}};
  const Volume wall = flat_wall({});
  const std::vector<TrialSettings> cases = passivity_cases(all_algorithms());
  std::vector<PassivityRow> rows(cases.size());
  in_parallel(cases.size(), [&](std::size_t n) { rows[n] = measure_passivity(cases[n], wall); });
  for (const AlgorithmDescription& algorithm : all_algorithms()) {
    std::vector<double> shares;
    int none = 0, all = 0;
    for (const PassivityRow& row : rows) {
      if (!(row.algorithm == algorithm.id)) continue;
      none += row.limit.kind == StiffnessLimit::Kind::below_all ? 1 : 0;
      all += row.limit.kind == StiffnessLimit::Kind::above_all ? 1 : 0;
      if (row.limit.kind == StiffnessLimit::Kind::found) {
        shares.push_back(row.limit.felt_N_per_mm / row.rule_N_per_mm);
      }
    }
    const double least = percentile(shares, 0), greatest = percentile(shares, 1);
    section.add_of(algorithm.id.name,
                   {algorithm.id.name, figure(least), figure(percentile(shares, 0.5)), figure(greatest),
                    std::to_string(none), std::to_string(all)},
                   none + all == 0 && least >= 0.95 && greatest <= 1.05);
  }
  return section;
}

}  // namespace osteomill::verification
