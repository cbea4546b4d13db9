#include "trials/hands_section.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/study/metric_table.h"
#include "osteomill/study/noticeable.h"
#include "osteomill/study/paper.h"

#include "trials/paired_comparison.h"

namespace osteomill {

namespace {

std::string interval_text(const MedianInterval& interval) {
  return fmt::format("{:.3g} [{:.3g}, {:.3g}]", interval.median, interval.low, interval.high);
}

// Returns the size of a difference: "54 % more than", "3.2 times", "0.08 more than" for zero.
std::string size_text(const PairedComparison& pair) {
  if (std::isinf(pair.share)) return in_two_digits(pair.difference) + " more than";
  return pair.share < 1 ? in_two_digits(100 * pair.share) + " % more than"
                        : in_two_digits(1 + pair.share) + " times";
}

// Returns a sentence for each pair: "2 is 3.2 times 1, p = 0.012" with the order strong if a hand notices it,
// "2 is 2 % more than 1 in 7 hands: same for a hand, p = 0.02", and "1 and 2: not settled, p = 0.3".
Cell differences(const Study& study, std::string_view phase, const Field<RunMetrics>& metric) {
  std::vector<Cell::Piece> pieces;
  for (const PairedComparison& pair : compare_algorithms(study, phase, metric)) {
    const std::string first = short_label(pair.first), second = short_label(pair.second);
    const std::string in_hands =
        pair.hands == study.seeds().size() ? "" : fmt::format(" in {} hands", pair.hands);
    if (!pieces.empty()) pieces.push_back({"\n"});
    if (!pair.is_settled()) {
      pieces.push_back({fmt::format("{} and {}{}: not settled, {}", first, second, in_hands, p_text(pair.p)),
                        CellStyle::faint});
      continue;
    }
    pieces.push_back({fmt::format("{} is {} {}{}", pair.second_is_greater ? second : first, size_text(pair),
                                  pair.second_is_greater ? first : second, in_hands),
                      pair.is_noticeable ? CellStyle::strong : CellStyle::faint});
    pieces.push_back(
        {fmt::format("{}{}, {}", pair.is_noticeable ? "" : ": same for a hand",
                     pair.is_less_than_tremor ? ", less than another tremor gives" : "", p_text(pair.p)),
         pair.is_noticeable ? CellStyle::plain : CellStyle::faint});
  }
  return pieces;
}

// Returns median and interval, "0.02 [0.01, 0.03]", without interval for one hand, with the number of hands
// if not measured in all, or why it was not measured in any.
Cell values_cell(const Study& study, const AlgorithmId& algorithm, std::string_view phase,
                 const Field<RunMetrics>& metric) {
  const std::vector<double> values = study.values(algorithm, phase, metric.get);
  const std::size_t hands = study.seeds().size();
  if (values.empty()) return {study.why_not_measured(algorithm, phase, metric.get), CellStyle::words};
  std::string text =
      hands == 1 ? fmt::format("{:.3g}", values.front()) : interval_text(median_interval(values));
  if (values.size() != hands) text += fmt::format(" in {} of {} hands", values.size(), hands);
  const double by_tremor = tremor_effect(study, algorithm, phase, metric);
  if (std::isnan(by_tremor)) return text;
  return std::vector<Cell::Piece>{{std::move(text)},
                                  {fmt::format("\ntremor {:.2g}", by_tremor), CellStyle::faint}};
}

// Returns a table without rows: a column for each algorithm and, with several hands, one for the differences.
Table comparison_table(const Study& study) {
  Table table{{study.seeds().size() > 1 ? "Median over the hands [interval]" : "In this hand"}, {}, true};
  for (const AlgorithmId& algorithm : study.algorithms()) table.header.push_back(algorithm.label);
  if (are_compared(study)) table.header.emplace_back("Differences");
  return table;
}

void add_figure(Table& table, const Study& study, std::string_view phase, const Field<RunMetrics>& metric) {
  std::vector<Cell>& row = table.rows.emplace_back(1, label_of(metric));
  for (const AlgorithmId& algorithm : study.algorithms())
    row.push_back(values_cell(study, algorithm, phase, metric));
  if (are_compared(study)) row.push_back(differences(study, phase, metric));
}

// Adds a row with what each algorithm did not reach, unless all completed the test.
void add_not_reached(Table& table, const Study& study, std::string_view phase) {
  std::vector<Cell> row{"not reached"};
  bool any = false;
  for (const AlgorithmId& algorithm : study.algorithms()) {
    const std::string words = study.not_reached(algorithm, phase);
    any = any || !words.empty();
    row.emplace_back(words, CellStyle::words);
  }
  if (any) table.rows.push_back(std::move(row));
}

Table algorithms_table(const Study& study, std::string_view phase) {
  Table table = comparison_table(study);
  add_not_reached(table, study, phase);
  for (const Field<RunMetrics>& metric : study.metrics_of(phase)) add_figure(table, study, phase, metric);
  return table;
}

// Returns paragraphs on what the numbers mean and how reliable they are.
std::vector<std::string> how_to_read(const Study& study) {
  const std::size_t n = study.seeds().size();
  std::vector<double> stiffness, damping;
  for (const MeasuredRun& row : study.rows()) {
    stiffness.push_back(row.hand_stiffness_N_per_m);
    damping.push_back(row.hand_damping_Ns_per_m);
  }
  const auto [softest, stiffest] = std::minmax_element(stiffness.begin(), stiffness.end());
  const auto [min, max] = std::minmax_element(damping.begin(), damping.end());
  const MedianInterval interval = median_interval(std::vector<double>(n, 0.0));
  const std::size_t pairs = study.algorithms().size() * (study.algorithms().size() - 1) / 2;
  const double min_corrected = std::min(1.0, static_cast<double>(std::max<std::size_t>(pairs, 1)) * min_p(n));
  std::vector<std::string> paragraphs{
      fmt::format("The same trial in {} hands: each seed (the first is {}) has a tremor and a hand of its "
                  "own, drawn evenly from the published ranges; here {:.0f} to {:.0f} N/m and {:.2g} to "
                  "{:.2g} N s/m. study.csv has every trial. Recordings are kept of seed {} alone, which is "
                  "the one that the figures of force, torque, shaft and path show.",
                  n, study.seeds().front(), *softest, *stiffest, *min, *max, study.seeds().front())};
  paragraphs.push_back(
      interval.is_range
          ? fmt::format(
                "Brackets give the range of all values: {} hands are too few for a 95 % interval of the "
                "median, which takes 6 (the range covers the median with a probability of {:.3g} %).",
                n, 100 * interval.coverage)
          : fmt::format("Brackets give a confidence interval of the median between two order statistics, by "
                        "the binomial distribution; its coverage is {:.3g} %. In a cell that names fewer "
                        "hands, the interval covers the median with 95 % or more; with fewer than six hands "
                        "it is their range.",
                        100 * interval.coverage));
  paragraphs.push_back(fmt::format(
      "Differences are tested hand by hand with Wilcoxon's signed-rank test, exact and two-sided, with "
      "Holm's correction over the comparisons of one row (not over the rows). The size of a difference is "
      "its median over the hands, in bold unless it is the same for a hand; one with p above {} is not "
      "settled. "
      "The smallest p that {} hands can give is {:.2g}, after the correction {:.2g}{}.",
      kSignificance, n, min_p(n), min_corrected,
      min_corrected > kSignificance ? ", so that no difference can be significant here and none is shown"
                                    : ""));
  paragraphs.push_back(about_noticeable());
  if (const std::size_t runs = tremor_run_count(study); runs > 0) {
    paragraphs.push_back(fmt::format(
        "Below a value is the effect of tremor alone: the difference between two runs of the same hand, that "
        "of seed {}, with different tremors (the median over the pairs of {} such runs). A smaller "
        "difference shows over many hands, but not from one run to the next.",
        study.seeds().front(), runs));
  }
  paragraphs.emplace_back(
      "Compute times depend on the machine: those of the first seed were measured with nothing else of this "
      "program running, the others with a trial on every other core as well. Everything else is the same on "
      "any machine.");
  return paragraphs;
}

std::string phase_title(std::string_view phase) {
  return phase == kMilling ? "Milling" : "Holding still, not milling";
}

}  // namespace

Section hands_section(const Study& study, const std::vector<CaptionedFigure>& figures) {
  Section section{.title = fmt::format("Study over {} hands", study.seeds().size()),
                  .paragraphs = how_to_read(study),
                  .figures = figures};
  for (const std::string_view phase : study.phases())
    section.parts.push_back({.title = phase_title(phase), .tables = {algorithms_table(study, phase)}});
  return section;
}

Section one_hole_section(const Study& study) {
  return {.title = "Holding still in one hole",
          .paragraphs = {fmt::format(
              "The holes of the algorithms differ, by up to a few millimetres, so what is felt while holding "
              "comes from both the algorithm and its hole. Here each hand milled once, with {}, and then "
              "held in that hole with every algorithm. The first second (at most half of the holding), in "
              "which the algorithms are exchanged, is not counted.",
              default_algorithm().id.label)},
          .tables = {algorithms_table(study, kHolding)}};
}

}  // namespace osteomill
