#include <thread>

#include "verification/sections.h"
#include <fmt/core.h>

#include "osteomill/experiment/paper.h"
#include "osteomill/experiment/study_findings.h"
#include "osteomill/experiment/study_trials.h"
#include "osteomill/operator/milling_entry.h"
#include "osteomill/volume/builtin_tooth.h"

namespace osteomill::verification {

namespace {

constexpr std::uint64_t kHands = 8;

std::vector<StudyTrial> trials_on(const Volume& bone, const std::string& name, double phase_s) {
  TrialSettings settings;
  settings.haptics.mode = Mode::paper;
  settings.hand_and_device.script.until_leant = true;
  settings.hand_and_device.script.milling_s = settings.hand_and_device.script.holding_s = phase_s;
  const TrialPlan plan{bone, name, estimate_densities(bone), place_entry(bone, settings.tool), settings, ""};
  std::vector<StudyTrial> trials;
  for (std::uint64_t seed = 1; seed <= kHands; ++seed) {
    for (const std::string_view algorithm : kPapersAlgorithms)
      trials.push_back({with_seed(plan, seed), algorithm_named(algorithm)});
  }
  return trials;
}

void add_rows(Section& section, const Volume& bone, const std::string& name, double phase_s) {
  const Study study(
      run_study_trials(trials_on(bone, name, phase_s), std::thread::hardware_concurrency(), {}));
  for (const StudyFinding& finding : check_study_findings(study, Mode::paper)) {
    if (finding.of_medians.of_the_machine) continue;
    section.add({fmt::format("{}: {}", name, finding.of_medians.paper_says), finding.of_medians.measured,
                 fmt::format("{} of {}", finding.agreeing, finding.tested)},
                finding.of_medians.verdict == Verdict::agrees);
  }
}

}  // namespace

Section papers_findings(const Bones& bones, const Effort& effort) {
  Section section{
      "What the paper found",
      fmt::format(
          "Must hold: what section 8.2 of the paper says of force, torque and shaft, by the rules of a "
          "comparison's report. The paper's three algorithms in `paper`, {} hands drawn by seed, the "
          "phases of `compare --seconds {:g}`. Medians of the hands in which the tool kept contact, where "
          "those are more than half; a finding that could not be tested misses.",
          kHands, effort.phase_s),
      {"scan: the paper found", "medians", "holds in hands", ""},
      {},
      {}};
  add_rows(section, bones.tooth, bones.tooth_name, effort.phase_s);
  add_rows(section, Volume(builtin_tooth(), kBuiltinToothIsovalue), "the built-in tooth", effort.phase_s);
  return section;
}

}  // namespace osteomill::verification
