#include "trials/conclusions.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "osteomill/study/paper.h"
#include "osteomill/study/study_findings.h"

#include "trials/statistics.h"
#include "trials/study_comparison.h"

namespace osteomill {

namespace {

bool too_few(const Study& study) {
  return study.seeds().size() < study.seeds_needed();
}

std::string hands(std::size_t count) {
  return count == 1 ? "one hand" : fmt::format("{} hands", count);
}

std::string during(std::string_view phase) {
  return phase == kMilling ? "while milling" : "while holding still";
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (std::size_t n = 0; n < parts.size(); ++n) {
    text += (n == 0 ? "" : n + 1 == parts.size() ? " and " : ", ") + parts[n];
  }
  return text;
}

// "; least with 3 point-shell, significantly against 1 and 2, not against 4", or that none is.
std::string least_words(const Study& study, std::string_view phase, const Field<RunMetrics>& metric,
                        const AlgorithmId& least) {
  std::vector<std::string> clear, unclear;
  for (const PairedComparison& pair : compare_algorithms(study, phase, metric.get)) {
    const AlgorithmId &first = pair.first, &second = pair.second;
    if (first != least && second != least) continue;
    const bool is_clear = pair.p <= kSignificance && pair.second_is_greater == (first == least);
    (is_clear ? clear : unclear).push_back(short_label(first == least ? second : first));
  }
  if (clear.empty()) return "; no difference between the least and another is significant";
  return fmt::format("; least with {}, significantly against {}{}", least.label, joined(clear),
                     unclear.empty() ? "" : ", not against " + joined(unclear));
}

// "0.02 N (1 line-proxy), lost contact after 3.2 s (2 surface-points) and 0.01 N (3 point-shell, in 7 of 8
// hands)", and who has least.
std::string values_words(const Study& study, std::string_view phase, const Field<RunMetrics>& metric) {
  std::vector<std::string> values;
  std::optional<AlgorithmId> least;
  double min = 0;
  for (const AlgorithmId& algorithm : study.algorithms()) {
    const std::vector<double> of_seeds = study.values(algorithm, phase, metric.get);
    if (of_seeds.empty()) {
      values.push_back(
          fmt::format("{} ({})", contact_words(study.contact(algorithm, phase)), algorithm.label));
      continue;
    }
    const double median = median_interval(of_seeds).median;
    const std::size_t all = study.seeds().size();
    values.push_back(
        fmt::format("{:.3g} {} ({}{})", median, metric.unit, algorithm.label,
                    of_seeds.size() < all ? fmt::format(", in {} of {} hands", of_seeds.size(), all) : ""));
    if (study.are_most(of_seeds.size()) && (!least || median < min)) least = algorithm, min = median;
  }
  const bool claims = metric.has(kLessIsBetter) && least && values.size() > 1 && !too_few(study);
  return joined(values) + (claims ? least_words(study, phase, metric, *least) : "");
}

// "Force above 20 Hz, rms, while milling, median of the hands: 0.02 N (1 line-proxy) ..."
std::string values_sentence(const Study& study, std::string_view phase, const Field<RunMetrics>& metric) {
  std::string text = fmt::format("{}, {}{}: ", metric.doc, during(phase),
                                 study.seeds().size() > 1 ? ", median of the hands" : "");
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return fmt::format("{}{}.", text, values_words(study, phase, metric));
}

// "…: 4 agree in 10 hands, 2 do not (…), 1 is not settled (… in 5 of 10), 1 could not be tested."
std::string findings_sentence(const Study& study) {
  const bool one = study.seeds().size() == 1;
  std::size_t total = 0, agreeing = 0, untested = 0;
  std::vector<std::string> against, open;
  for (const StudyFinding& f : check_study_findings(study)) {
    if (f.of_medians.of_the_machine) continue;
    ++total;
    agreeing += f.verdict == Verdict::agrees;
    untested += !is_tested(f.verdict);
    const std::string says =
        f.of_medians.paper_says + (one ? "" : fmt::format(", in {} of {}", f.agreeing, f.tested));
    if (f.verdict == Verdict::does_not_agree) against.push_back(says);
    if (f.verdict == Verdict::not_settled) open.push_back(says);
  }
  std::string text = fmt::format("Of the paper's {} findings on force, torque and shaft, {} {} in {}", total,
                                 agreeing, agreeing == 1 ? "agrees" : "agree", hands(study.seeds().size()));
  const auto add = [&](const std::vector<std::string>& which, const char* of_one, const char* of_more) {
    if (which.empty()) return;
    text += fmt::format(", {} {} ({})", which.size(), which.size() == 1 ? of_one : of_more,
                        fmt::join(which, "; "));
  };
  add(against, "does not", "do not");
  add(open, "is not settled", "are not settled");
  if (untested > 0) text += fmt::format(", {} could not be tested", untested);
  return text + ".";
}

// Who did not come to do all of it.
std::string not_reached(const Study& study) {
  std::vector<std::string> who;
  for (const AlgorithmId& algorithm : study.algorithms()) {
    if (!study.not_reached(algorithm, kHolding).empty()) who.push_back(algorithm.label);
  }
  return who.empty() ? ""
                     : fmt::format(" Not all of that was reached with {}: the tables say what.", joined(who));
}

// In whose holding the shaft did not do what it was to.
std::string not_leaning(const Study& study) {
  constexpr double kLeans = 0.5;
  std::vector<std::string> who;
  for (const AlgorithmId& algorithm : study.algorithms()) {
    const std::vector<double> shares =
        study.values(algorithm, kHolding, [](const RunMetrics& m) { return m.contact.shaft; });
    const auto few = std::count_if(shares.begin(), shares.end(), [](double share) { return share < kLeans; });
    if (few == 0) continue;
    who.push_back(algorithm.label +
                  (shares.size() == 1 ? "" : fmt::format(" ({} of {} hands)", few, shares.size())));
  }
  return who.empty()
             ? ""
             : fmt::format(" The shaft stood against the wall for less than half of that time with {}.",
                           joined(who));
}

}  // namespace

std::string what_was_compared(const Study& study, std::string_view scan_name) {
  std::vector<std::string> algorithms;
  for (const AlgorithmId& algorithm : study.algorithms()) algorithms.push_back(algorithm.label);
  return fmt::format(
      "{} milled the same bone ({}) in {}. Each was to move the burr in until it touched, mill a "
      "hole and push the shaft against the hole's edge; then, with the spindle off, to stand in that hole "
      "with the shaft against the wall and keep as still as it could.{}",
      joined(algorithms), scan_name,
      study.seeds().size() == 1 ? "one simulated hand"
                                : fmt::format("{} simulated hands", study.seeds().size()),
      not_leaning(study) + not_reached(study));
}

std::string too_few_hands(const Study& study) {
  if (!too_few(study)) return "";
  return fmt::format(
      "Only {} tried this, too few to say which algorithm is the better: a difference shows in {} or more "
      "(--seeds {}). The numbers are those of this trial.",
      hands(study.seeds().size()), study.seeds_needed(), study.seeds_needed());
}

std::vector<std::string> conclusions(const Study& study) {
  std::vector<std::string> sentences;
  const auto tell = [&](std::string_view phase, const char* column) {
    const auto phases = study.phases();
    if (std::find(phases.begin(), phases.end(), phase) != phases.end())
      sentences.push_back(values_sentence(study, phase, metric(column)));
  };
  tell(kMilling, "force_hp_rms_N");
  tell(kMilling, "torque_hp_rms_Nmm");
  tell(kHolding, "shaft_spread_deg");
  sentences.push_back(findings_sentence(study));
  tell(kMilling, "removed_mm3");
  return sentences;
}

}  // namespace osteomill
