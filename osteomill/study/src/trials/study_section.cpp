#include "trials/study_section.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/study/metric_table.h"
#include "osteomill/study/noticeable.h"
#include "osteomill/study/paper.h"
#include "osteomill/study/study_findings.h"

#include "trials/statistics.h"

namespace osteomill {

std::vector<std::string> labels_of(const std::vector<AlgorithmId>& algorithms) {
  std::vector<std::string> labels;
  for (const AlgorithmId& algorithm : algorithms) labels.push_back(algorithm.label);
  return labels;
}

std::string in_words(const std::vector<std::string>& all) {
  if (all.size() < 2) return fmt::format("{}", fmt::join(all, ""));
  return fmt::format("{} and {}", fmt::join(all.begin(), all.end() - 1, ", "), all.back());
}

namespace {

constexpr std::size_t kColumns = 4;
constexpr std::size_t kMaxPanels = 12;
// In units of the distance between two algorithms.
constexpr double kScatter = 0.2;
constexpr double kBarHalf = 0.15;

std::vector<double> all_values(const Study& study, std::string_view phase, const Field<RunMetrics>& metric) {
  std::vector<double> all;
  for (const AlgorithmId& algorithm : study.algorithms()) {
    const auto values = study.values(algorithm, phase, metric.get);
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

// Whole decades if the values spread, so that at least two tics have a number.
std::string range_for(const std::vector<double>& values) {
  if (values.empty()) return "unset logscale y\nset yrange [0:1]\n";
  const auto [min, max] = std::minmax_element(values.begin(), values.end());
  if (*min > 0 && *max > 4 * *min) {
    return fmt::format("set logscale y\nset yrange [{:.6g}:{:.6g}]\n",
                       std::pow(10.0, std::floor(std::log10(*min) + 1e-9)),
                       std::pow(10.0, std::ceil(std::log10(*max) - 1e-9)));
  }
  return fmt::format("unset logscale y\nset yrange [0:{:.6g}]\n", *max > 0 ? 1.15 * *max : 1.0);
}

// Two blocks: the dots, and the bars at the medians.
std::string dots_and_bars(const std::vector<double>& values, double x) {
  std::string dots, bars;
  const double last = std::max<double>(1, static_cast<double>(values.size()) - 1);
  for (std::size_t n = 0; n < values.size(); ++n) {
    const double across = kScatter * (static_cast<double>(n) / last - 0.5);
    dots += fmt::format("{:.4f} {:.6g}\n", values.size() > 1 ? x + across : x, values[n]);
  }
  const double median = distribution_of(values).median;
  bars = fmt::format("{:.4f} {:.6g}\n{:.4f} {:.6g}\n", x - kBarHalf, median, x + kBarHalf, median);
  return dots + "\n\n" + bars;
}

std::string tics(const Study& study) {
  std::string list;
  int place = 0;
  for (const AlgorithmId& algorithm : study.algorithms()) {
    list += fmt::format("{}'{}' {}", place == 0 ? "" : ", ", short_label(algorithm), place);
    ++place;
  }
  return fmt::format("set xrange [-0.5:{}]\nset xtics scale 0 ({})\n", static_cast<double>(place) - 0.5,
                     list);
}

std::string panel(const Study& study, std::string_view phase, const Field<RunMetrics>& metric,
                  FigureScript& figure) {
  std::string plot;
  int place = 0;
  for (const AlgorithmId& algorithm : study.algorithms()) {
    const double x = place++;
    const std::vector<double> values = study.values(algorithm, phase, metric.get);
    if (values.empty()) continue;
    plot += fmt::format(
        "{0}{1} index 1 with lines lw 2.5 lc rgb '{2}' notitle, {1} index 0 with points pt 7 ps 0.8 lw 1.3 "
        "lc rgb '{2}' notitle",
        plot.empty() ? "plot " : ", ", figure.data(dots_and_bars(values, x)), algorithm.colour);
  }
  return range_for(all_values(study, phase, metric)) + plot + "\n";
}

// Breaks a text that is wider than a panel at the blank nearest to its middle, but not between a number and
// its unit.
std::string in_two_lines(std::string text) {
  constexpr std::size_t kMostInALine = 26;
  if (text.size() <= kMostInALine) return text;
  std::size_t nearest = std::string::npos, least = text.size();
  for (std::size_t blank = text.find(' '); blank != std::string::npos; blank = text.find(' ', blank + 1)) {
    const std::size_t off = 2 * blank > text.size() ? 2 * blank - text.size() : text.size() - 2 * blank;
    const bool is_in_number = blank > 0 && text[blank - 1] >= '0' && text[blank - 1] <= '9';
    if (is_in_number || off >= least) continue;
    nearest = blank;
    least = off;
  }
  if (nearest != std::string::npos) text.replace(nearest, 1, "\\n");
  return text;
}

// The title stands over the whole panel: some are wider than its axes.
std::string title(const Field<RunMetrics>& metric, const PanelGrid& grid, const PanelCell& cell) {
  constexpr double kTitle_px = 28;
  return fmt::format("set label 2 \"{}\" at screen {:.4f},screen {:.4f} center\n",
                     in_two_lines(label_of(metric)),
                     (cell.left_px + 0.55 * cell.wide_px) / PanelGrid::kWidth_px,
                     (cell.top_px - kTitle_px) / grid.height_px);
}

std::vector<LegendEntry> legend(const Study& study, std::string_view phase) {
  constexpr std::string_view kInk = "#111111";
  std::vector<LegendEntry> entries{{phase == kMilling ? "Milling:" : "Holding still:", kInk, 125}};
  for (const AlgorithmId& algorithm : study.algorithms())
    entries.push_back({algorithm.label, algorithm.colour, 155});
  entries.push_back({"a dot for each hand, a bar at the median", kInk, 310});
  return entries;
}

std::string interval_text(const MedianInterval& interval) {
  return fmt::format("{:.3g} [{:.3g}, {:.3g}]", interval.median, interval.low, interval.high);
}

// Returns a number with two digits, or all of those before the point.
std::string in_two_digits(double value) {
  return std::abs(value) < 99.5 ? fmt::format("{:.2g}", value) : fmt::format("{:.0f}", value);
}

// "54 % more than", "3.2 times", "0.08 more than" zero.
std::string size_text(const PairedComparison& pair) {
  if (std::isinf(pair.share)) return in_two_digits(pair.difference) + " more than";
  return pair.share < 1 ? in_two_digits(100 * pair.share) + " % more than"
                        : in_two_digits(1 + pair.share) + " times";
}

// A sentence for each pair: "2 is 3.2 times 1, p = 0.012" with the order strong if a hand notices it, "2 is 2
// % more than 1: same for a hand, p = 0.02", and "1 and 2: not settled, p = 0.3".
Cell differences(const Study& study, std::string_view phase, const Field<RunMetrics>& metric) {
  std::vector<Cell::Piece> pieces;
  for (const PairedComparison& pair : compare_algorithms(study, phase, metric)) {
    const std::string first = short_label(pair.first), second = short_label(pair.second);
    if (!pieces.empty()) pieces.push_back({"\n"});
    if (!pair.is_settled()) {
      pieces.push_back(
          {fmt::format("{} and {}: not settled, {}", first, second, p_text(pair.p)), Look::faint});
      continue;
    }
    pieces.push_back({fmt::format("{} is {} {}", pair.second_is_greater ? second : first, size_text(pair),
                                  pair.second_is_greater ? first : second),
                      pair.is_noticeable ? Look::strong : Look::faint});
    pieces.push_back(
        {fmt::format("{}{}, {}", pair.is_noticeable ? "" : ": same for a hand",
                     pair.is_less_than_tremor ? ", less than another tremor gives" : "", p_text(pair.p)),
         pair.is_noticeable ? Look::plain : Look::faint});
  }
  return pieces;
}

// Returns by how much the figure differs between two runs of one hand that differ in its tremor alone: the
// median over the pairs of runs; not a number if no hand tried other tremors.
double given_by_tremor(const Study& study, const AlgorithmId& algorithm, std::string_view phase,
                       const Field<RunMetrics>& figure) {
  const std::vector<double> values = study.values_by_tremor(algorithm, phase, figure.get);
  std::vector<double> differences;
  for (std::size_t a = 0; a < values.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) differences.push_back(std::abs(values[a] - values[b]));
  return differences.empty() ? kNotMeasured : distribution_of(differences).median;
}

// "0.02 [0.01, 0.03]", of one hand without the interval, and with the hands if it could not be measured in
// all; else why not in any.
Cell values_cell(const Study& study, const AlgorithmId& algorithm, std::string_view phase,
                 const Field<RunMetrics>& metric) {
  const std::vector<double> values = study.values(algorithm, phase, metric.get);
  const std::size_t hands = study.seeds().size();
  if (values.empty()) return {contact_words(study.contact(algorithm, phase)), Look::words};
  std::string text =
      hands == 1 ? fmt::format("{:.3g}", values.front()) : interval_text(median_interval(values));
  if (values.size() != hands) text += fmt::format(" in {} of {} hands", values.size(), hands);
  const double by_tremor = given_by_tremor(study, algorithm, phase, metric);
  if (std::isnan(by_tremor) || metric.has(kOfTheMachine)) return text;
  return std::vector<Cell::Piece>{{std::move(text)},
                                  {fmt::format("\ntremor {:.2g}", by_tremor), Look::faint}};
}

// Fewer hands cannot show a difference.
bool are_compared(const Study& study) {
  return study.algorithms().size() > 1 && study.seeds().size() >= study.seeds_needed();
}

// Returns a table without rows: a column for each algorithm and, with several hands, one for the differences.
Table comparison_table(const Study& study) {
  Table table{{study.seeds().size() > 1 ? "Median over the hands [interval]" : "In this hand"}, {}, true};
  for (const AlgorithmId& algorithm : study.algorithms()) table.header.push_back(algorithm.label);
  if (are_compared(study)) table.header.emplace_back("Differences");
  return table;
}

void add_figure(Table& table, const Study& study, std::string_view phase, const Field<RunMetrics>& metric,
                const std::string& label) {
  std::vector<Cell>& row = table.rows.emplace_back(1, label);
  for (const AlgorithmId& algorithm : study.algorithms())
    row.push_back(values_cell(study, algorithm, phase, metric));
  if (are_compared(study)) row.push_back(differences(study, phase, metric));
}

// Adds a row with the `words` of each algorithm; none if all are empty.
template <typename Words>
void add_words(Table& table, const Study& study, const char* label, const Words& words) {
  std::vector<Cell> row{label};
  bool any = false;
  for (const AlgorithmId& algorithm : study.algorithms()) {
    const std::string said = words(algorithm);
    any = any || !said.empty();
    row.emplace_back(said, Look::words);
  }
  if (any) table.rows.push_back(std::move(row));
}

void add_not_reached(Table& table, const Study& study, std::string_view phase) {
  add_words(table, study, "not reached",
            [&](const AlgorithmId& algorithm) { return study.not_reached(algorithm, phase); });
}

Table algorithms_table(const Study& study, std::string_view phase) {
  Table table = comparison_table(study);
  add_not_reached(table, study, phase);
  for (const Field<RunMetrics>& metric : study.metrics_of(phase))
    add_figure(table, study, phase, metric, label_of(metric));
  return table;
}

// Returns how many runs of one hand differ in its tremor alone; 0 if no hand tried others.
std::size_t tremors_tried(const Study& study) {
  if (study.phases().empty()) return 0;
  const auto steps = [](const RunMetrics& m) { return m.steps; };
  return study.values_by_tremor(study.algorithms().front(), study.phases().front(), steps).size();
}

// Returns paragraphs on the meaning of the numbers and how far they can be trusted.
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
  std::vector<std::string> paragraphs{fmt::format(
      "The same trial in {} hands: each seed (the first is {}) has a tremor and a hand of its own, drawn "
      "evenly from the published ranges; here {:.0f} to {:.0f} N/m and {:.2g} to {:.2g} N s/m. study.csv has "
      "every trial. Recordings are kept of seed {} alone, which is the one that the figures of force, "
      "torque, shaft and path show.",
      n, study.seeds().front(), *softest, *stiffest, *min, *max, study.seeds().front())};
  paragraphs.push_back(
      interval.is_range
          ? fmt::format("In brackets stands the range of all values: {} hands are too few for a 95 % "
                        "interval of the median, which takes 6 (the range covers it with {:.3g} %).",
                        n, 100 * interval.coverage)
          : fmt::format("In brackets stands a confidence interval of the median between two order "
                        "statistics, by the binomial distribution; it covers the median with {:.3g} %.",
                        100 * interval.coverage));
  paragraphs.push_back(fmt::format(
      "Differences are tested hand by hand with Wilcoxon's signed-rank test, exact and two-sided, corrected "
      "after Holm over what is compared in one row (not over the rows). The size of a "
      "difference is its median over the hands, in bold if a hand notices it; one with p above {} is not "
      "settled. The least p that {} hands can give is "
      "{:.2g}, after the correction {:.2g}{}.",
      kSignificance, n, min_p(n), min_corrected,
      min_corrected > kSignificance ? ", so that no difference can be significant here and none is shown"
                                    : ""));
  paragraphs.push_back(about_noticeable());
  if (const std::size_t runs = tremors_tried(study); runs > 0) {
    paragraphs.push_back(fmt::format(
        "Below a value stands what tremor alone gives: by how much two runs differ in which one and the same "
        "hand, that of seed {}, has another tremor (the median over the pairs of {} such runs). A difference "
        "below that shows over many hands, but not from one run to the next.",
        study.seeds().front(), runs));
  }
  paragraphs.emplace_back(
      "Compute times are the machine's: those of the first seed were taken with nothing else of this program "
      "running, the others with a trial beside on each further core. Everything else comes out the same on "
      "any machine.");
  return paragraphs;
}

// One hand settles nothing: its cell says whether the rule holds in it.
Cell verdict_cell(const StudyFinding& finding, bool one_hand) {
  const Verdict verdict = one_hand ? finding.of_medians.verdict : finding.verdict;
  if (one_hand && verdict == Verdict::agrees) return {"holds in this hand", Look::faint};
  if (one_hand && verdict == Verdict::does_not_agree) return {"does not hold in this hand", Look::faint};
  return {std::string(name_of(verdict)), verdict == Verdict::agrees           ? Look::agrees
                                         : verdict == Verdict::does_not_agree ? Look::differs
                                                                              : Look::faint};
}

// Returns the findings of which there is what they need.
std::vector<StudyFinding> recorded_findings(const Study& study) {
  std::vector<StudyFinding> findings = check_study_findings(study);
  std::erase_if(findings, [](const StudyFinding& finding) {
    return finding.of_medians.verdict == Verdict::not_recorded;
  });
  return findings;
}

Table findings_table(const Study& study, const std::vector<StudyFinding>& findings) {
  const bool one = study.seeds().size() == 1;
  Table table{{"The paper found", one ? "Measured here" : "Medians over the hands",
               one ? "In one hand, which settles nothing" : "Verdict", "Rule"},
              {}};
  if (!one) table.header.insert(table.header.end() - 1, {"In how many hands", "Sign test"});
  for (const StudyFinding& f : findings) {
    std::vector<Cell> row{f.of_medians.paper_says, f.of_medians.measured, verdict_cell(f, one)};
    if (!one) row.insert(row.end(), {fmt::format("{} of {}", f.agreeing, f.tested), p_text(f.p)});
    row.emplace_back((one ? "holds if " : "agrees if ") + f.of_medians.rule);
    table.rows.push_back(std::move(row));
  }
  return table;
}

// Returns a table of the number of findings with each verdict, and of those that do not agree.
Table verdicts_table(const Study& study) {
  const bool one = study.seeds().size() == 1;
  struct Findings {
    Cell verdict;
    std::vector<std::string> which;
  };
  std::map<Verdict, Findings> findings;
  std::size_t all = 0;
  for (const StudyFinding& f : recorded_findings(study)) {
    if (f.of_medians.of_the_machine) continue;
    ++all;
    Findings& alike = findings[one ? f.of_medians.verdict : f.verdict];
    alike.verdict = verdict_cell(f, one);
    alike.which.push_back(f.of_medians.paper_says);
    if (!one && is_tested(f.verdict))
      alike.which.back() += fmt::format(", in {} of {} hands", f.agreeing, f.tested);
  }
  Table table{
      {fmt::format("{} of the paper's findings on force, torque and shaft", all), "How many", "Which"}, {}};
  for (const auto& [verdict, alike] : findings) {
    table.rows.push_back(
        {alike.verdict, fmt::format("{}", alike.which.size()),
         verdict == Verdict::agrees ? "" : fmt::format("{}", fmt::join(alike.which, ";\n"))});
  }
  return table;
}

// A reason to choose an algorithm: a figure of a phase, of which less is better.
struct Question {
  const char* name;
  std::string_view phase;
  const char* column;
};

std::vector<Question> questions_of(const Study& study) {
  std::vector<Question> all{
      {"calm force while milling", kMilling, "force_hp_share"},
      {"calm torque while milling", kMilling, "torque_hp_share"},
      {"calm force while holding", kHolding, "force_hp_share"},
      {"calm torque while holding", kHolding, "torque_hp_share"},
      {"a shaft that follows the handle while milling", kMilling, "shaft_from_handle_deg"}};
  const std::vector<std::string_view> phases = study.phases();
  std::erase_if(all,
                [&](const Question& one) { return std::ranges::find(phases, one.phase) == phases.end(); });
  return all;
}

// An algorithm's place in a question.
struct Rank {
  AlgorithmId algorithm;
  std::size_t place = 1;
  // False if the figure is missing in half of the hands or more: it has no place, and takes none.
  bool is_measured = true;
  // Short labels of those against which the hands do not settle it, and of those that are the same for a
  // hand.
  std::vector<std::string> open = {}, alike = {};

  bool is_first() const { return is_measured && open.empty() && place == 1; }
};

// Ranks these algorithms among themselves.
std::vector<Rank> ranks_of(const Study& study, const Question& question,
                           const std::vector<AlgorithmId>& algorithms) {
  std::vector<Rank> ranks;
  const Field<RunMetrics>& figure = metric(question.column);
  for (const AlgorithmId& algorithm : algorithms)
    ranks.push_back(
        {.algorithm = algorithm,
         .is_measured = study.are_most(study.values(algorithm, question.phase, figure.get).size())});
  for (const PairedComparison& pair : compare_algorithms(study, question.phase, figure)) {
    const auto first = std::ranges::find(ranks, pair.first, &Rank::algorithm);
    const auto second = std::ranges::find(ranks, pair.second, &Rank::algorithm);
    if (first == ranks.end() || second == ranks.end() || !first->is_measured || !second->is_measured)
      continue;
    if (pair.is_settled() && pair.is_noticeable) {
      ++(pair.second_is_greater ? second : first)->place;
      continue;
    }
    const auto list = pair.is_settled() ? &Rank::alike : &Rank::open;
    ((*first).*list).push_back(short_label(pair.second));
    ((*second).*list).push_back(short_label(pair.first));
  }
  return ranks;
}

std::string rank_text(const Rank& rank) {
  constexpr const char* kEndings[] = {"th", "st", "nd", "rd"};
  if (!rank.is_measured) return "no rank";
  if (!rank.open.empty()) return fmt::format("not settled\nagainst {}", fmt::join(rank.open, ", "));
  const std::string place = fmt::format("{}{}", rank.place, kEndings[rank.place < 4 ? rank.place : 0]);
  if (rank.alike.empty()) return place;
  return fmt::format("{}, same for\na hand as {}", place, fmt::join(rank.alike, ", "));
}

// In how many hands the algorithm did all of the test, milling and holding.
std::size_t hands_that_did_all(const Study& study, const AlgorithmId& algorithm) {
  std::size_t done = 0;
  for (std::size_t seed = 0; seed < study.seeds().size(); ++seed) {
    done += std::ranges::all_of(study.rows_of_seed(seed), [&](const MeasuredRun& run) {
      return run.algorithm != algorithm || (run.not_reached.empty() && !run.metrics.contact.is_lost());
    });
  }
  return done;
}

std::string share_text(double share) {
  return std::isnan(share) ? "–" : fmt::format("{:.2g} %", 100 * share);
}

// The questions' names as the heads of columns, with what stands in their cells.
std::string head_of(const Question& question) {
  std::string head = question.name;
  head[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(head[0])));
  const Field<RunMetrics>& figure = metric(question.column);
  return fmt::format("{}\n{}", head,
                     figure.unit.empty() ? "above 20 Hz, of the mean" : "spread, " + figure.unit);
}

// Returns the value of one hand and those with other tremors, or of several the median and the rank.
Cell answer_cell(const Study& study, const Question& question, const Rank& rank) {
  const Field<RunMetrics>& figure = metric(question.column);
  const auto text_of = [&](double value) {
    return figure.unit.empty() ? share_text(value) : in_two_digits(value);
  };
  const std::vector<double> values = study.values(rank.algorithm, question.phase, figure.get);
  if (values.empty()) return {contact_words(study.contact(rank.algorithm, question.phase)), Look::words};
  std::vector<Cell::Piece> cell{{text_of(distribution_of(values).median)}};
  if (values.size() < study.seeds().size())
    cell.push_back({fmt::format("\n{} of {} hands", values.size(), study.seeds().size()), Look::faint});
  if (are_compared(study))
    cell.push_back({"\n" + rank_text(rank), rank.is_first() ? Look::strong : Look::faint});
  if (study.seeds().size() > 1) return cell;
  const std::vector<double> by_tremor = study.values_by_tremor(rank.algorithm, question.phase, figure.get);
  if (by_tremor.size() > 1) {
    const auto [least, most] = std::ranges::minmax(by_tremor);
    const std::string from = figure.unit.empty() ? fmt::format("{:.2g}", 100 * least) : in_two_digits(least);
    cell.push_back({fmt::format("\n{} to {}", from, text_of(most)), Look::faint});
  }
  return cell;
}

Table answer_table(const Study& study, const std::map<std::string, Probe>& probes) {
  Table table{{study.seeds().size() > 1   ? "Median over the hands"
               : tremors_tried(study) > 1 ? "In this hand\n(with other tremors)"
                                          : "In this hand"},
              {},
              true};
  for (const AlgorithmId& algorithm : study.algorithms()) table.rows.push_back({algorithm.label});
  for (const Question& question : questions_of(study)) {
    table.header.push_back(head_of(question));
    const std::vector<Rank> ranks = ranks_of(study, question, study.algorithms());
    for (std::size_t n = 0; n < ranks.size(); ++n)
      table.rows[n].push_back(answer_cell(study, question, ranks[n]));
  }
  table.header.emplace_back("Did all of the test\nhands");
  if (!probes.empty())
    table.header.insert(table.header.end(),
                        {"Torque of the shaft on an edge\nerror", "Felt stiffness of a wall\nN/mm"});
  table.header.emplace_back("A tick of milling takes\nmedian, µs");
  const Field<RunMetrics>& cost = metric("tick_us_median");
  for (std::size_t n = 0; n < table.rows.size(); ++n) {
    const AlgorithmId algorithm = study.algorithms()[n];
    std::vector<Cell>& row = table.rows[n];
    row.emplace_back(fmt::format("{} of {}", hands_that_did_all(study, algorithm), study.seeds().size()));
    if (!probes.empty()) {
      const auto probed = probes.find(algorithm.name);
      const bool is_probed = probed != probes.end();
      row.emplace_back(!is_probed                                ? "–"
                       : std::isnan(probed->second.torque_error) ? "no force felt"
                                                                 : share_text(probed->second.torque_error));
      row.emplace_back(is_probed ? fmt::format("{:.3g}", probed->second.felt_N_per_mm) : "–");
    }
    row.emplace_back(in_two_digits(distribution_of(study.values(algorithm, kMilling, cost.get)).median));
  }
  return table;
}

std::string phase_title(std::string_view phase) {
  return phase == kMilling ? "Milling" : "Holding still, not milling";
}

}  // namespace

Figure draw_study_figure(const Study& study, std::string_view phase, const std::filesystem::path& folder) {
  std::vector<Field<RunMetrics>> metrics = study.metrics_of(phase);
  if (metrics.size() > kMaxPanels) metrics.resize(kMaxPanels);
  PanelGrid grid{.columns = kColumns,
                 .rows = std::max<std::size_t>((metrics.size() + kColumns - 1) / kColumns, 1),
                 .head_px = 52,
                 .left_px = 76,
                 .right_px = 10,
                 .above_px = 64,
                 .below_px = 36};
  grid.height_px = grid.head_px + 310 * static_cast<double>(grid.rows);
  return draw_panels(
      fmt::format("study_{}", phase), grid,
      begin_panels("y") + "set format y '%g'\n" + tics(study) + legend_row(grid, legend(study, phase)),
      [&](std::size_t column, std::size_t row, FigureScript& figure) {
        const std::size_t n = row * kColumns + column;
        if (n >= metrics.size()) return std::string();
        return title(metrics[n], grid, panel_cell(grid, column, row)) +
               panel(study, phase, metrics[n], figure) + "unset label\n";
      },
      folder);
}

std::vector<PairedComparison> compare_algorithms(const Study& study, std::string_view phase,
                                                 const Field<RunMetrics>& figure) {
  const std::vector<AlgorithmId> algorithms = study.algorithms();
  std::vector<PairedComparison> comparisons;
  std::vector<double> p;
  for (std::size_t a = 0; a < algorithms.size(); ++a) {
    for (std::size_t b = a + 1; b < algorithms.size(); ++b) {
      const std::vector<double> of_first = study.all_values(algorithms[a], phase, figure.get);
      const std::vector<double> of_second = study.all_values(algorithms[b], phase, figure.get);
      std::vector<double> differences, first, second;
      for (std::size_t n = 0; n < std::min(of_first.size(), of_second.size()); ++n) {
        if (std::isnan(of_first[n] - of_second[n])) continue;
        differences.push_back(of_first[n] - of_second[n]);
        first.push_back(of_first[n]);
        second.push_back(of_second[n]);
      }
      if (differences.empty()) continue;
      const SignedRank test = signed_rank(differences);
      PairedComparison& pair = comparisons.emplace_back(
          PairedComparison{algorithms[a], algorithms[b], test.negative > test.positive});
      const double lesser =
          std::min(std::abs(distribution_of(first).median), std::abs(distribution_of(second).median));
      pair.difference = std::abs(distribution_of(differences).median);
      pair.share = pair.difference / lesser;
      pair.is_noticeable = pair.difference >= least_noticeable(figure, lesser);
      // False if no hand tried other tremors.
      pair.is_less_than_tremor =
          pair.difference < std::fmax(given_by_tremor(study, algorithms[a], phase, figure),
                                      given_by_tremor(study, algorithms[b], phase, figure));
      p.push_back(test.p);
    }
  }
  const std::vector<double> corrected = holm_corrected(p);
  for (std::size_t n = 0; n < comparisons.size(); ++n) comparisons[n].p = corrected[n];
  return comparisons;
}

std::string what_was_compared(const Study& study, std::string_view scan_name) {
  const std::size_t hands = study.seeds().size();
  const bool one = study.algorithms().size() == 1;
  return fmt::format(
      "{} milled {} ({}) in {}. {} was to move the burr in until it touched, mill a hole and push the shaft "
      "against the hole's edge; then, with the spindle off, to stand in that hole with the shaft against the "
      "wall and keep as still as it could.",
      in_words(labels_of(study.algorithms())), one ? "a bone" : "the same bone", scan_name,
      hands == 1 ? "one simulated hand" : fmt::format("{} simulated hands", hands), one ? "It" : "Each");
}

std::string about_the_table(const Study& study) {
  std::string text =
      "How calm a force or torque is stands in the table as its rms above 20 Hz, where a hand feels a buzz "
      "and "
      "no longer follows, against its mean. The shaft is that of the simulated tool; its spread against the "
      "handle is 0 if an algorithm shows the tool where the handle is.";
  if (study.seeds().size() == 1 && tremors_tried(study) > 1)
    text += fmt::format(
        " Below each value stands the range over {} runs of this hand that differ in its tremor "
        "alone.",
        tremors_tried(study));
  return text;
}

std::string too_few_hands(const Study& study) {
  const std::size_t hands = study.seeds().size(), needed = study.seeds_needed();
  if (hands >= needed || study.algorithms().size() == 1) return "";
  return fmt::format(
      "Only {} tried this, too few to say which algorithm is better: it takes {} or more to show a "
      "difference "
      "(--seeds {}). The numbers are those of {}.",
      hands == 1 ? "one hand" : fmt::format("{} hands", hands), needed, needed,
      hands == 1 ? "this trial" : "these trials");
}

std::vector<Table> conclusions(const Study& study, const std::map<std::string, Probe>& probes) {
  std::vector<Table> tables{answer_table(study, probes), verdicts_table(study)};
  if (tables.back().rows.empty()) tables.pop_back();
  return tables;
}

namespace {

// "1.3 % against 2.8 % with the next"
std::string reason_for(const Study& study, const Question& question, const AlgorithmId& best,
                       const std::vector<AlgorithmId>& others) {
  const Field<RunMetrics>& figure = metric(question.column);
  const auto median = [&](const AlgorithmId& algorithm) {
    return distribution_of(study.values(algorithm, question.phase, figure.get)).median;
  };
  double next = std::numeric_limits<double>::infinity();
  for (const AlgorithmId& other : others)
    if (other != best && !study.values(other, question.phase, figure.get).empty())
      next = std::min(next, median(other));
  const auto text = [&](double value) {
    return figure.unit.empty() ? share_text(value) : in_two_digits(value) + " " + figure.unit;
  };
  return fmt::format("{} ({}, the next {})", question.name, text(median(best)), text(next));
}

}  // namespace

// An algorithm whose test most hands could not do is taken for nothing, however calm it is.
std::string which_to_take(const Study& study) {
  if (!are_compared(study)) return "";
  std::vector<AlgorithmId> candidates;
  std::vector<std::string> left_out;
  for (const AlgorithmId& algorithm : study.algorithms()) {
    const std::size_t done = hands_that_did_all(study, algorithm);
    if (study.are_most(done))
      candidates.push_back(algorithm);
    else
      left_out.push_back(fmt::format("{} ({} of {} hands did all of the test with it)", algorithm.label, done,
                                     study.seeds().size()));
  }
  if (candidates.size() < 2)
    return fmt::format("None is recommended, because too few did all of the test: {}.", in_words(left_out));
  std::map<AlgorithmId, std::vector<std::string>> reasons;
  std::vector<std::string> same, open;
  for (const Question& question : questions_of(study)) {
    std::vector<Rank> first = ranks_of(study, question, candidates);
    std::erase_if(first, [](const Rank& rank) { return !rank.is_first(); });
    if (first.empty())
      open.emplace_back(question.name);
    else if (first.size() > 1)
      same.emplace_back(question.name);
    else
      reasons[first.front().algorithm].push_back(
          reason_for(study, question, first.front().algorithm, candidates));
  }
  std::vector<std::string> sentences;
  for (const auto& [algorithm, names] : reasons)
    sentences.push_back(fmt::format("Take {} for {}.", algorithm.label, in_words(names)));
  if (!same.empty())
    sentences.push_back(fmt::format("The best are the same for a hand in this: {}.", in_words(same)));
  if (!open.empty()) sentences.push_back(fmt::format("Not settled: {}.", in_words(open)));
  if (!left_out.empty()) sentences.push_back(fmt::format("Not considered: {}.", in_words(left_out)));
  return fmt::format("{}", fmt::join(sentences, " "));
}

Section study_section(const Study& study, const std::vector<CaptionedFigure>& figures) {
  Section section{.title = fmt::format("Study over {} hands", study.seeds().size()),
                  .paragraphs = how_to_read(study),
                  .figures = figures};
  for (const std::string_view phase : study.phases())
    section.parts.push_back({.title = phase_title(phase), .tables = {algorithms_table(study, phase)}});
  return section;
}

Section one_hole_section(const Study& study) {
  return {
      .title = "Holding still in one hole",
      .paragraphs = {fmt::format(
          "The holes of the algorithms differ, by up to a few millimetres, so what is felt while holding "
          "comes "
          "from both the algorithm and its hole. Here each hand milled once, with {}, and then held in that "
          "hole with every algorithm. The first second (at most half of the holding), in which the "
          "algorithms "
          "are exchanged, is not counted.",
          default_algorithm().id.label)},
      .tables = {algorithms_table(study, kHolding)}};
}

Section findings_section(const Study& study) {
  const std::vector<StudyFinding> findings = recorded_findings(study);
  if (findings.empty()) return {};
  Section section{
      .title = "The paper's findings",
      .paragraphs = {
          "What section 8.2 of the paper says it found, each held against what was measured by a rule of "
          "this project. The paper does not give its hand, push and bone, so a finding that does not hold "
          "here may hold there."}};
  if (const std::size_t missing = check_study_findings(study).size() - findings.size(); missing > 0) {
    section.paragraphs.push_back(
        fmt::format("{} further finding{} to algorithms, phases or grips that were not tried here.", missing,
                    missing == 1 ? " belongs" : "s belong"));
  }
  if (study.seeds().size() > 1) {
    section.paragraphs.push_back(
        "Hands agree with the paper, or do not, if more than half do, and tossing a coin would give as many "
        "in "
        "one of twenty tries at most, which takes five hands; else it is not settled. p is the chance that "
        "as "
        "many or more would agree by the toss.");
  }
  section.tables = {findings_table(study, findings)};
  return section;
}

}  // namespace osteomill
