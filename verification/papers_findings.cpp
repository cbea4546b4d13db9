#include <algorithm>
#include <functional>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "osteomill/base/machine.h"
#include "osteomill/session/milling_entry.h"
#include "osteomill/study/findings.h"
#include "osteomill/study/paper.h"
#include "osteomill/study/run_trials.h"
#include "osteomill/study/study_findings.h"
#include "osteomill/volume/builtin_tooth.h"

#include "verification/sections.h"

namespace osteomill::verification {

namespace {

struct Hands {
  std::uint64_t first, last;
};
// Settings were chosen with kTuningHands, on the built-in tooth.
constexpr Hands kTuningHands{1, 8};
constexpr Hands kTestHands{9, 24};

using Change = std::function<void(TrialSettings&)>;

// Runs the given algorithms of the paper (numbered from 1) on the bone with every hand, algorithm 2 also with
// every grip.
std::vector<MeasuredRun> rows_on(const Volume& bone, Hands hands, double phase_s,
                                 const std::vector<std::size_t>& algorithms, const Change& change) {
  TrialSettings settings;
  ScriptSettings& script = settings.hand_and_device.script;
  script.until_leant = true;
  script.milling_s = script.holding_s = phase_s;
  const TrialPlan plan{bone,     {"", 0}, estimate_densities(bone), place_entry(bone, settings.tool),
                       settings, ""};
  std::vector<TrialPlan> trials;
  for (std::uint64_t seed = hands.first; seed <= hands.last; ++seed) {
    TrialPlan in_hand = with_seed(plan, seed);
    change(in_hand.settings);
    for (const std::size_t n : algorithms) {
      trials.push_back(in_hand);
      trials.back().settings.algorithm = algorithm_named(kPapersAlgorithms[n - 1]);
      if (n != 2) continue;
      for (const TrialPlan& grip : trials_in_other_grips(in_hand)) trials.push_back(grip);
    }
  }
  return run_study_trials(trials, allowed_threads(), {});
}

const std::vector<std::size_t> kAll{1, 2, 3};
const Change kNothing = [](TrialSettings&) {};

std::vector<MeasuredRun> rows_on(const Volume& bone, Hands hands, double phase_s) {
  return rows_on(bone, hands, phase_s, kAll, kNothing);
}

// Adds a row for each finding. Returns the number of findings that the hands do not settle.
std::size_t add_findings(Section& section, const Volume& bone, const std::string& name, Hands hands,
                         double phase_s) {
  int number = 0;
  std::size_t unsettled = 0;
  for (const StudyFinding& finding : check_study_findings(Study(rows_on(bone, hands, phase_s)))) {
    unsettled += finding.verdict == Verdict::not_settled;
    const char* settled = finding.verdict == Verdict::not_settled ? ", not settled" : "";
    section.add(
        {fmt::format("{}, {} to {}: {}. {}", name, hands.first, hands.last, ++number,
                     finding.of_medians.paper_says),
         finding.of_medians.measured, fmt::format("{} of {}{}", finding.agreeing, finding.tested, settled)},
        finding.of_medians.verdict == Verdict::agrees);
  }
  return unsettled;
}

// A change of one of the paper's open choices, of the hand or of the device.
struct Choice {
  std::string what;
  // Algorithms whose trials it changes, numbered from 1.
  std::vector<std::size_t> algorithms;
  Change change;
};

Choice setting(std::size_t algorithm, const char* name, double value) {
  const std::string of(kPapersAlgorithms[algorithm - 1]);
  return {fmt::format("`{}.{}={:g}`", of, name, value), {algorithm}, [=](TrialSettings& settings) {
            settings.haptics.named.push_back({of, name, value});
          }};
}

std::vector<Choice> choices() {
  const auto of_person = [](const char* what, auto change) {
    return Choice{what, kAll, [change](TrialSettings& s) { change(s.hand_and_device); }};
  };
  Choice softer = setting(3, "translational-stiffness", 2);
  softer.what = "`point-shell` with a coupling of 2 N/mm and 1000 N mm/rad";
  softer.change = [](TrialSettings& settings) {
    settings.haptics.named.push_back({"point-shell", "translational-stiffness", 2});
    settings.haptics.named.push_back({"point-shell", "torsional-stiffness", 1000});
  };
  return {
      setting(1, "stiffness", 2),
      setting(1, "stiffness", 8),
      setting(2, "stiffness", 10),
      setting(2, "stiffness", 40),
      setting(3, "scale", 1),
      setting(3, "damping-time", 0),
      std::move(softer),
      of_person("a hand damping of 20 N s/m, twice the largest drawn",
                [](OperatorSettings& p) {
                  p.hand.damping_Ns_per_mm = 0.02;
                  p.hand.torsional_damping_Nmms_per_rad = 20;
                }),
      of_person("a hand tremor without rotation", [](OperatorSettings& p) { p.hand.tremor_rad = 0; }),
      of_person("a push of 3 N", [](OperatorSettings& p) { p.hand.push_N = 3; }),
      of_person("a device of 0.1 kg",
                [](OperatorSettings& p) {
                  p.handle.mass_kg /= 3;
                  p.handle.inertia_kg_m2 /= 3;
                }),
      of_person("a device of 0.9 kg",
                [](OperatorSettings& p) {
                  p.handle.mass_kg *= 3;
                  p.handle.inertia_kg_m2 *= 3;
                }),
  };
}

double median_of(const Study& study, std::size_t algorithm, std::string_view phase,
                 double (*value)(const RunMetrics&)) {
  return distribution_of(study.values(algorithm_named(kPapersAlgorithms[algorithm - 1]).id, phase, value))
      .median;
}

// Adds a row: the number of findings that hold, the numbers of the others, and the figures that the choices
// change. Returns the number that hold.
std::size_t add_choice(Section& section, const std::string& name, std::vector<MeasuredRun> rows) {
  const Study study(std::move(rows));
  std::vector<std::size_t> missing;
  const std::vector<StudyFinding> findings = check_study_findings(study);
  for (std::size_t n = 0; n < findings.size(); ++n) {
    if (findings[n].of_medians.verdict != Verdict::agrees) missing.push_back(n + 1);
  }
  const auto of_all = [&](std::string_view phase, double (*value)(const RunMetrics&)) {
    return fmt::format("{} / {} / {}", figure(median_of(study, 1, phase, value)),
                       figure(median_of(study, 2, phase, value)), figure(median_of(study, 3, phase, value)));
  };
  const auto force = [](const RunMetrics& m) { return m.force_N.hp_rms; };
  const auto torque = [](const RunMetrics& m) { return m.torque_Nmm.hp_rms; };
  section.rows.push_back(
      {name,
       missing.empty()
           ? fmt::format("{}", findings.size())
           : fmt::format("{}, not {}", findings.size() - missing.size(), fmt::join(missing, ", ")),
       of_all(kMilling, force), of_all(kHolding, force), of_all(kMilling, torque), of_all(kHolding, torque)});
  return findings.size() - missing.size();
}

// Adds a row for each choice. Returns, as text, the fewest findings that hold and the choice that leaves
// them.
std::string add_choices(Section& section, const Volume& bone, const std::string& name, double phase_s) {
  const std::vector<MeasuredRun> unchanged_rows = rows_on(bone, kTuningHands, phase_s);
  std::size_t fewest = add_choice(section, fmt::format("{}, unchanged", name), unchanged_rows);
  std::string with = "nothing changed";
  for (const Choice& choice : choices()) {
    std::vector<MeasuredRun> rows = rows_on(bone, kTuningHands, phase_s, choice.algorithms, choice.change);
    for (const MeasuredRun& row : unchanged_rows) {
      const auto is_it = [&](std::size_t n) { return row.algorithm == kPapersAlgorithms[n - 1]; };
      if (std::none_of(choice.algorithms.begin(), choice.algorithms.end(), is_it)) rows.push_back(row);
    }
    const std::size_t hold = add_choice(section, fmt::format("{}, {}", name, choice.what), std::move(rows));
    if (hold >= fewest) continue;
    fewest = hold;
    with = choice.what;
  }
  return fmt::format("{} of {} on {} with {}", fewest, kFindings, name, with);
}

}  // namespace

Section papers_findings(const Bones& bones, const Effort& effort) {
  Section section{
      "What the paper found",
      fmt::format(
          "Must hold: the nine findings of section 8 of the paper, in the medians over hands, by the "
          "rules of the report of `compare`. *Not settled*: too few hands agree for the report's sign "
          "test, which the medians need not pass. The paper's three algorithms, hands drawn by seed ({} "
          "to {}, with which the paper's open choices were settled on the built-in tooth, and {} to "
          "{}), and the phases of `compare --seconds {:g}`. Medians are over the hands in which the "
          "tool kept contact, if those are more than half; a finding that could not be tested misses.",
          kTuningHands.first, kTuningHands.last, kTestHands.first, kTestHands.last, effort.phase_s),
      {"bone, hands: the paper found", "medians", "holds in hands", ""},
      {},
      {}};
  const Volume builtin(builtin_tooth(), kBuiltinToothIsovalue);
  std::size_t unsettled = 0;
  for (const Hands hands : {kTuningHands, kTestHands}) {
    unsettled += add_findings(section, builtin, "the built-in tooth", hands, effort.phase_s);
    unsettled += add_findings(section, bones.tooth, bones.tooth_name, hands, effort.phase_s);
  }
  section.reservation =
      fmt::format("in the medians, {} of them not settled by the sign test over hands", unsettled);
  return section;
}

Section papers_choices(const Bones& bones, const Effort& effort) {
  Section section{
      "What the paper leaves open",
      fmt::format(
          "Reported: the same findings, numbered as above from 1 to 9, with one choice, the hand or the "
          "device changed. Hands {} to {}, medians; force above 20 Hz (rms, N) and torque above 20 Hz "
          "(rms, N mm) of 1 / 2 / 3.",
          kTuningHands.first, kTuningHands.last),
      {"bone, with", "findings that hold", "force milling", "force holding", "torque milling",
       "torque holding"},
      {},
      {}};
  const std::string on_builtin = add_choices(section, Volume(builtin_tooth(), kBuiltinToothIsovalue),
                                             "the built-in tooth", effort.phase_s);
  section.reservation =
      fmt::format("with one choice, the hand or the device changed, as few as {} and {}", on_builtin,
                  add_choices(section, bones.tooth, bones.tooth_name, effort.phase_s));
  return section;
}

}  // namespace osteomill::verification
