#include "osteomill/experiment/study_words.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "osteomill/experiment/paper.h"
#include "osteomill/experiment/study_comparison.h"
#include "osteomill/experiment/study_findings.h"
#include "osteomill/report/run_groups.h"

namespace osteomill {

namespace {

// What a hand feels as unrest, by its place among the key metrics.
const KeyMetric& force_buzz() {
  return key_metrics()[0];
}
const KeyMetric& torque_buzz() {
  return key_metrics()[3];
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (std::size_t n = 0; n < parts.size(); ++n) {
    text += (n == 0 ? "" : n + 1 == parts.size() ? " and " : ", ") + parts[n];
  }
  return text;
}

std::string findings_sentence(const Study& study, Mode mode) {
  std::size_t tested = 0;
  std::size_t agreeing = 0;
  std::vector<std::string> against;
  for (const StudyFinding& f : check_study_findings(study, mode)) {
    if (f.of_medians.of_the_machine) continue;
    tested += is_tested(f.of_medians.verdict);
    agreeing += f.of_medians.verdict == Verdict::agrees;
    if (f.of_medians.verdict == Verdict::does_not_agree) {
      against.push_back(fmt::format("“{}” ({} of {} hands)", f.of_medians.paper_says, f.agreeing, f.tested));
    }
  }
  return fmt::format(
      "Over {} hands, {} of the paper's {} findings on force, torque and shaft hold in the medians of mode "
      "{}{}.",
      study.seeds().size(), agreeing, tested, name_of(mode),
      against.empty() ? "" : "; not so " + joined(against));
}

// "lowers the force of 2 surface-points (× 0.12) and torque of 1 line-proxy (× 0.3)"
std::string changes_sentence(const Study& study, std::string_view phase) {
  std::vector<std::string> less, more, unclear;
  for (const KeyMetric* metric : {&force_buzz(), &torque_buzz()}) {
    for (const ModeChange& change : compare_modes(study, phase, *metric)) {
      const std::string what =
          fmt::format("{} of {}{}", metric == &force_buzz() ? "force" : "torque", change.algorithm.label,
                      change.ratios > 0 ? fmt::format(" (× {:.3g})", change.ratio.median) : "");
      (change.p > kSignificance ? unclear : change.falls ? less : more).push_back(what);
    }
  }
  std::vector<std::string> parts;
  if (!less.empty()) parts.push_back("lowers the " + joined(less));
  if (!more.empty()) parts.push_back("raises the " + joined(more));
  if (!unclear.empty()) parts.push_back("does not significantly change the " + joined(unclear));
  return fmt::format("Of what lies above 20 Hz while {}, steady {}.",
                     phase == kMilling ? "milling" : "holding", joined(parts));
}

// The algorithm with the least median, and whether it is significantly less than each other one.
std::string steadiest(const Study& study, std::string_view phase, const KeyMetric& metric) {
  const Mode mode = study.modes().front();
  std::optional<AlgorithmId> best;
  double min = 0;
  for (const AlgorithmId& algorithm : study.algorithms()) {
    const std::vector<double> values = study.values(algorithm, mode, phase, metric);
    if (values.empty()) continue;
    const double median = median_interval(values).median;
    if (!best || median < min) best = algorithm, min = median;
  }
  if (!best) return "none, since none touched";
  const auto pairs = compare_algorithms(study, mode, phase, metric);
  const bool clear = std::all_of(pairs.begin(), pairs.end(), [&](const AlgorithmPair& pair) {
    const bool about_best = pair.first == *best || pair.second == *best;
    return !about_best || (pair.p <= kSignificance && pair.greater != *best);
  });
  return fmt::format("{} ({}significant)", best->label, clear ? "" : "not ");
}

}  // namespace

std::string study_in_two_sentences(const Study& study) {
  const std::string_view phase = study.phases().front();
  std::string text = findings_sentence(study, study.modes().front()) + " ";
  if (study.modes().size() > 1) return text + changes_sentence(study, phase);
  if (study.algorithms().size() < 2)
    return text + "One algorithm was tried, so that there is none to compare.";
  return text +
         fmt::format("While {}, the least above 20 Hz came in the force from {} and in the torque from {}.",
                     phase == kMilling ? "milling" : "holding", steadiest(study, phase, force_buzz()),
                     steadiest(study, phase, torque_buzz()));
}

}  // namespace osteomill
