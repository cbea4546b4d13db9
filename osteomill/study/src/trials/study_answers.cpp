#include "trials/study_answers.h"

#include <algorithm>
#include <cmath>
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

// A criterion for choosing an algorithm: a figure of a phase; less is better.
struct Criterion {
  const char* name;
  std::string_view phase;
  const char* column;
  // Verdict on the best algorithm, and the comparative for less.
  const char* is_best;
  const char* less;
};

std::vector<Criterion> criteria_of(const Study& study) {
  std::vector<Criterion> all{
      {"calm force while milling", kMilling, "force_hp_share", "is calmest in force while milling", "calmer"},
      {"calm torque while milling", kMilling, "torque_hp_share", "is calmest in torque while milling",
       "calmer"},
      {"calm force while holding", kHolding, "force_hp_share", "is calmest in force while holding", "calmer"},
      {"calm torque while holding", kHolding, "torque_hp_share", "is calmest in torque while holding",
       "calmer"},
      {"a shaft that follows the handle while milling", kMilling, "shaft_from_handle_deg",
       "keeps its shaft nearest to the handle while milling", "nearer"}};
  const std::vector<std::string_view> phases = study.phases();
  std::erase_if(all,
                [&](const Criterion& one) { return std::ranges::find(phases, one.phase) == phases.end(); });
  return all;
}

// Returns the number of hands in which the algorithm completed the test, milling and holding.
std::size_t completed_hand_count(const Study& study, const AlgorithmId& algorithm) {
  std::size_t done = 0;
  for (std::size_t seed = 0; seed < study.seeds().size(); ++seed) {
    done += std::ranges::all_of(study.rows_of_seed(seed), [&](const MeasuredRun& run) {
      return run.algorithm != algorithm || (run.not_reached.empty() && !run.metrics.contact.is_lost());
    });
  }
  return done;
}

// "0 of 8"
std::string completed_text(const Study& study, const AlgorithmId& algorithm) {
  return fmt::format("{} of {}", completed_hand_count(study, algorithm), study.seeds().size());
}

// Only algorithms that completed the test in most hands are ranked, however calm the others are.
struct Considered {
  std::vector<AlgorithmId> in, out;
};

Considered considered(const Study& study) {
  Considered all;
  for (const AlgorithmId& algorithm : study.algorithms())
    (study.are_most(completed_hand_count(study, algorithm)) ? all.in : all.out).push_back(algorithm);
  return all;
}

// Place of an algorithm by one criterion.
struct Rank {
  AlgorithmId algorithm;
  std::size_t place = 1;
  // False if the figure is missing in half of the hands or more: it has no place and takes none.
  bool is_measured = true;
  // Algorithms from which the hands do not separate it, and those that feel the same to a hand.
  std::vector<AlgorithmId> open = {}, alike = {};

  bool is_first() const { return is_measured && open.empty() && place == 1; }
};

std::vector<Rank> ranks_of(const Study& study, const Criterion& question,
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
    ((*first).*list).push_back(pair.second);
    ((*second).*list).push_back(pair.first);
  }
  return ranks;
}

std::string rank_text(const Rank& rank) {
  constexpr const char* kEndings[] = {"th", "st", "nd", "rd"};
  const auto short_labels = [](const std::vector<AlgorithmId>& algorithms) {
    std::string labels;
    for (const AlgorithmId& algorithm : algorithms)
      labels += (labels.empty() ? "" : ", ") + short_label(algorithm);
    return labels;
  };
  if (!rank.is_measured) return "no rank";
  if (!rank.open.empty()) return "not settled\nagainst " + short_labels(rank.open);
  const std::string place = fmt::format("{}{}", rank.place, kEndings[rank.place < 4 ? rank.place : 0]);
  if (rank.alike.empty()) return place;
  return fmt::format("{}, same for\na hand as {}", place, short_labels(rank.alike));
}

std::string share_text(double share) {
  return std::isnan(share) ? "–" : fmt::format("{:.2g} %", 100 * share);
}

// Returns a column heading: the criterion's name, with what its cells contain.
std::string head_of(const Criterion& question) {
  std::string head = question.name;
  head[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(head[0])));
  const Field<RunMetrics>& figure = metric(question.column);
  return fmt::format("{}\n{}\n(less is {})", head,
                     figure.unit.empty() ? "above 20 Hz, of the mean" : "spread, " + figure.unit,
                     question.less);
}

// Returns the rank among the algorithms considered; empty if there is only one.
std::vector<Cell::Piece> rank_pieces(const Study& study, const AlgorithmId& algorithm,
                                     const std::vector<Rank>& ranks) {
  if (!are_compared(study)) return {};
  const auto rank = std::ranges::find(ranks, algorithm, &Rank::algorithm);
  if (rank == ranks.end()) return {{"\nnot considered", CellStyle::faint}};
  if (ranks.size() == 1) return {};
  return {{"\n" + rank_text(*rank), rank->is_first() ? CellStyle::strong : CellStyle::faint}};
}

// Returns the value of a single hand and of its other tremors, or the median and rank of several hands.
Cell answer_cell(const Study& study, const Criterion& question, const AlgorithmId& algorithm,
                 const std::vector<Rank>& ranks) {
  const Field<RunMetrics>& figure = metric(question.column);
  const auto text_of = [&](double value) {
    return figure.unit.empty() ? share_text(value) : in_two_digits(value);
  };
  const std::vector<double> values = study.values(algorithm, question.phase, figure.get);
  if (values.empty())
    return {study.why_not_measured(algorithm, question.phase, figure.get), CellStyle::words};
  std::vector<Cell::Piece> cell{{text_of(distribution_of(values).median)}};
  if (values.size() < study.seeds().size())
    cell.push_back({fmt::format("\n{} of {} hands", values.size(), study.seeds().size()), CellStyle::faint});
  const std::vector<Cell::Piece> rank = rank_pieces(study, algorithm, ranks);
  cell.insert(cell.end(), rank.begin(), rank.end());
  if (study.seeds().size() > 1) return cell;
  const std::vector<double> by_tremor = study.values_by_tremor(algorithm, question.phase, figure.get);
  if (by_tremor.size() > 1) {
    const auto [least, most] = std::ranges::minmax(by_tremor);
    const std::string from = figure.unit.empty() ? fmt::format("{:.2g}", 100 * least) : in_two_digits(least);
    cell.push_back({fmt::format("\n{} to {}", from, text_of(most)), CellStyle::faint});
  }
  return cell;
}

Table answer_table(const Study& study, const std::map<std::string, Probe>& probes) {
  Table table{{study.seeds().size() > 1      ? "Median over the hands"
               : tremor_run_count(study) > 1 ? "In this hand\n(with other tremors)"
                                             : "In this hand"},
              {},
              true};
  const std::vector<AlgorithmId> algorithms = study.algorithms();
  for (const AlgorithmId& algorithm : algorithms) table.rows.push_back({algorithm.label});
  const std::vector<AlgorithmId> ranked = considered(study).in;
  for (const Criterion& question : criteria_of(study)) {
    table.header.push_back(head_of(question));
    const std::vector<Rank> ranks = ranks_of(study, question, ranked);
    for (std::size_t n = 0; n < algorithms.size(); ++n)
      table.rows[n].push_back(answer_cell(study, question, algorithms[n], ranks));
  }
  table.header.emplace_back("Did all of the test\nhands");
  if (!probes.empty())
    table.header.insert(table.header.end(),
                        {"Torque of the shaft on an edge\nerror", "Felt stiffness of a wall\nN/mm"});
  table.header.emplace_back("A tick of milling takes\nmedian, µs");
  const Field<RunMetrics>& cost = metric("tick_us_median");
  for (std::size_t n = 0; n < table.rows.size(); ++n) {
    std::vector<Cell>& row = table.rows[n];
    row.emplace_back(completed_text(study, algorithms[n]));
    if (!probes.empty()) {
      const auto probed = probes.find(algorithms[n].name);
      const bool is_probed = probed != probes.end();
      row.emplace_back(!is_probed                                ? "–"
                       : std::isnan(probed->second.torque_error) ? "no force felt"
                                                                 : share_text(probed->second.torque_error));
      row.emplace_back(is_probed ? fmt::format("{:.3g}", probed->second.felt_N_per_mm) : "–");
    }
    row.emplace_back(in_two_digits(distribution_of(study.values(algorithms[n], kMilling, cost.get)).median));
  }
  return table;
}

}  // namespace

std::string comparison_sentence(const Study& study, std::string_view bone) {
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

std::string table_explanation(const Study& study) {
  std::string text =
      "The table rates how calm a force or torque is by its rms above 20 Hz, which a hand feels as a buzz "
      "and cannot follow, relative to its mean. The shaft is that of the simulated tool; its spread against "
      "the handle is 0 if an algorithm shows the tool at the handle.";
  if (study.seeds().size() == 1 && tremor_run_count(study) > 1)
    text +=
        fmt::format(" Below each value is the range over {} runs of this hand that differ only in tremor.",
                    tremor_run_count(study));
  if (are_compared(study) && !considered(study).out.empty())
    text += " Ranks are those among the algorithms that did all of the test in most hands.";
  return text;
}

std::string sample_size_warning(const Study& study) {
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

// A criterion with its results over the hands.
struct Answers {
  const Study& study;
  const Criterion& question;
  const Field<RunMetrics>& figure = metric(question.column);
  std::vector<PairedComparison> pairs = compare_algorithms(study, question.phase, figure);

  double median(const AlgorithmId& algorithm) const {
    return distribution_of(study.values(algorithm, question.phase, figure.get)).median;
  }
  // Returns the median as text: "6.9 %".
  std::string value(const AlgorithmId& algorithm) const {
    return figure.unit.empty() ? share_text(median(algorithm))
                               : in_two_digits(median(algorithm)) + " " + figure.unit;
  }
  const PairedComparison* pair(const AlgorithmId& a, const AlgorithmId& b) const {
    const auto found = std::ranges::find_if(pairs, [&](const PairedComparison& one) {
      return (one.first == a && one.second == b) || (one.first == b && one.second == a);
    });
    return found == pairs.end() ? nullptr : &*found;
  }
  // Returns the test result: ", p = 0.023, 8 hands".
  std::string test(const AlgorithmId& a, const AlgorithmId& b) const {
    const PairedComparison* tested = pair(a, b);
    return tested == nullptr ? "" : fmt::format(", {}, {} hands", p_text(tested->p), tested->hands);
  }
  // Returns those of the algorithms that were measured in most hands, in ascending order.
  std::vector<AlgorithmId> by_median(std::vector<AlgorithmId> algorithms) const {
    std::erase_if(algorithms, [&](const AlgorithmId& one) {
      return !study.are_most(study.values(one, question.phase, figure.get).size());
    });
    std::ranges::stable_sort(algorithms, {}, [&](const AlgorithmId& one) { return median(one); });
    return algorithms;
  }
};

// "4 barrier-shell is calmest in force while milling: 2.6 % (3 point-shell 6.9 %, p = 0.023, 8 hands)."
std::string best_words(const Answers& answers, const AlgorithmId& best,
                       const std::vector<AlgorithmId>& by_median) {
  const auto next = std::ranges::find_if(by_median, [&](const AlgorithmId& one) { return one != best; });
  return fmt::format("{} {}: {} ({} {}{}).", best.label, answers.question.is_best, answers.value(best),
                     next->label, answers.value(*next), answers.test(best, *next));
}

// Returns a sentence on each algorithm that is not considered but had less than the best.
std::vector<std::string> words_on_less(const Answers& answers, const AlgorithmId& best,
                                       const std::vector<AlgorithmId>& not_considered) {
  std::vector<std::string> sentences;
  for (const AlgorithmId& other : answers.by_median(not_considered)) {
    const PairedComparison* pair = answers.pair(best, other);
    if (pair == nullptr) continue;
    const bool is_less = pair->is_settled() ? (pair->first == other) == pair->second_is_greater
                                            : answers.median(other) < answers.median(best);
    if (!is_less) continue;
    const std::string had =
        pair->is_settled() && pair->is_noticeable
            ? fmt::format("was {}", answers.question.less)
            : fmt::format("had less, {}",
                          pair->is_settled() ? "though the same for a hand" : "which is not settled");
    sentences.push_back(fmt::format("{} {} ({}{}), but did all of the test in {} hands.", other.label, had,
                                    answers.value(other), answers.test(best, other),
                                    completed_text(answers.study, other)));
  }
  return sentences;
}

// Names the best algorithms that are not separated: "calm force while holding (3 point-shell 3.1 %, 4
// barrier-shell 3.5 %, p = 0.38, 8 hands)".
std::string open_words(const Answers& answers, const std::vector<Rank>& ranks,
                       const std::vector<AlgorithmId>& by_median) {
  const AlgorithmId& least = by_median.front();
  const auto rank = std::ranges::find(ranks, least, &Rank::algorithm);
  const auto next = std::ranges::find_if(by_median, [&](const AlgorithmId& one) {
    return std::ranges::find(rank->open, one) != rank->open.end();
  });
  if (next == by_median.end()) return answers.question.name;
  return fmt::format("{} ({} {}, {} {}{})", answers.question.name, least.label, answers.value(least),
                     next->label, answers.value(*next), answers.test(least, *next));
}

// "a shaft that follows the handle while milling (3 point-shell 0.097 degrees, 4 barrier-shell 0.21 degrees)"
std::string alike_words(const Answers& answers, const std::vector<Rank>& first) {
  std::string list;
  for (const Rank& rank : first)
    list +=
        fmt::format("{}{} {}", list.empty() ? "" : ", ", rank.algorithm.label, answers.value(rank.algorithm));
  return fmt::format("{} ({})", answers.question.name, list);
}

// "1 line-proxy (0 of 8) and 2 surface-points (3 of 8)"
std::string hands_in_words(const Study& study, const std::vector<AlgorithmId>& algorithms) {
  std::vector<std::string> all;
  for (const AlgorithmId& algorithm : algorithms)
    all.push_back(fmt::format("{} ({})", algorithm.label, completed_text(study, algorithm)));
  return in_words(all);
}

}  // namespace

std::string recommendation_text(const Study& study) {
  if (!are_compared(study)) return "";
  const auto [in, out] = considered(study);
  if (in.empty())
    return fmt::format("None did all of the test in most hands, so nothing is compared: {}.",
                       hands_in_words(study, out));
  if (in.size() == 1)
    return fmt::format("Only {} did all of the test in most hands, so nothing is compared; {} did not.",
                       hands_in_words(study, in), hands_in_words(study, out));
  std::vector<std::string> sentences, same, open, unmeasured;
  for (const Criterion& question : criteria_of(study)) {
    const Answers answers{study, question};
    const std::vector<Rank> ranks = ranks_of(study, question, in);
    const std::vector<AlgorithmId> by_median = answers.by_median(in);
    std::vector<Rank> first = ranks;
    std::erase_if(first, [](const Rank& rank) { return !rank.is_first(); });
    if (by_median.size() < 2) {
      unmeasured.emplace_back(question.name);
    } else if (first.empty()) {
      open.push_back(open_words(answers, ranks, by_median));
    } else if (first.size() > 1) {
      same.push_back(alike_words(answers, first));
    } else {
      const AlgorithmId& best = first.front().algorithm;
      const bool begins = sentences.empty() && !out.empty();
      sentences.push_back((begins ? "Of the algorithms that did all of the test in most hands, " : "") +
                          best_words(answers, best, by_median));
      for (std::string& less : words_on_less(answers, best, out)) sentences.push_back(std::move(less));
    }
  }
  if (!same.empty())
    sentences.push_back(fmt::format("The best are the same for a hand in this: {}.", in_words(same)));
  if (!open.empty()) sentences.push_back(fmt::format("Not settled: {}.", in_words(open)));
  if (!unmeasured.empty())
    sentences.push_back(
        fmt::format("Not compared, because most hands felt too little of it: {}.", in_words(unmeasured)));
  if (!out.empty())
    sentences.push_back(fmt::format("Not considered, because too few hands did all of the test: {}.",
                                    hands_in_words(study, out)));
  return fmt::format("{}", fmt::join(sentences, " "));
}

}  // namespace osteomill
