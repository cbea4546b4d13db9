#include "trials/study_answers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "osteomill/study/metric_table.h"
#include "osteomill/study/paper.h"

#include "trials/findings_section.h"
#include "trials/paired_comparison.h"

namespace osteomill {

std::string labels_in_words(const std::vector<AlgorithmId>& algorithms) {
  std::vector<std::string> labels;
  for (const AlgorithmId& algorithm : algorithms) labels.push_back(algorithm.label);
  return in_words(labels);
}

namespace {

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

}  // namespace

std::string what_was_compared(const Study& study, std::string_view bone) {
  const std::size_t hands = study.seeds().size();
  const bool one = study.algorithms().size() == 1;
  return fmt::format(
      "{} milled {}{} in {}. {} was to move the burr in until it touched, mill a hole and push the shaft "
      "against the hole's edge; then, with the spindle off, to stand in that hole with the shaft against the "
      "wall and keep as still as it could.",
      labels_in_words(study.algorithms()), one ? "a bone" : "the same bone",
      bone.empty() ? "" : fmt::format(" ({})", bone),
      hands == 1 ? "one simulated hand" : fmt::format("{} simulated hands", hands), one ? "It" : "Each");
}

std::string about_the_table(const Study& study) {
  std::string text =
      "How calm a force or torque is stands in the table as its rms above 20 Hz, where a hand feels a buzz "
      "and no longer follows, against its mean. The shaft is that of the simulated tool; its spread against "
      "the handle is 0 if an algorithm shows the tool where the handle is.";
  if (study.seeds().size() == 1 && tremors_tried(study) > 1)
    text += fmt::format(
        " Below each value stands the range over {} runs of this hand that differ in its tremor alone.",
        tremors_tried(study));
  return text;
}

std::string too_few_hands(const Study& study) {
  const std::size_t hands = study.seeds().size(), needed = study.seeds_needed();
  if (hands >= needed || study.algorithms().size() == 1) return "";
  return fmt::format(
      "Only {} tried this, too few to say which algorithm is better: it takes {} or more to show a "
      "difference. The numbers are those of {}.",
      hands == 1 ? "one hand" : fmt::format("{} hands", hands), needed,
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
      left_out.push_back(fmt::format("{} ({} of {})", algorithm.label, done, study.seeds().size()));
  }
  if (candidates.size() < 2)
    return fmt::format("None is recommended, because too few hands did all of the test: {}.",
                       in_words(left_out));
  std::map<AlgorithmId, std::vector<std::string>> reasons;
  std::vector<std::string> same, open, unmeasured;
  for (const Question& question : questions_of(study)) {
    std::vector<Rank> first = ranks_of(study, question, candidates);
    const auto measured = std::ranges::count_if(first, &Rank::is_measured);
    std::erase_if(first, [](const Rank& rank) { return !rank.is_first(); });
    if (measured < 2)
      unmeasured.emplace_back(question.name);
    else if (first.empty())
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
  if (!unmeasured.empty())
    sentences.push_back(
        fmt::format("Not compared, because most hands felt too little of it: {}.", in_words(unmeasured)));
  if (!left_out.empty())
    sentences.push_back(
        fmt::format("Not considered, because too few hands did all of the test: {}.", in_words(left_out)));
  return fmt::format("{}", fmt::join(sentences, " "));
}

}  // namespace osteomill
