#include "osteomill/study/study.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/parse_number.h"
#include "osteomill/study/metric_table.h"
#include "osteomill/study/paper.h"

#include "trials/csv_table.h"
#include "trials/statistics.h"

namespace osteomill {

namespace {

std::string columns() {
  return "seed" + csv_names(fields_of<MeasuredRun>()) + "," + summary_columns();
}

using M = RunMetrics;

// Sorts phase before algorithm, as in summary.csv.
auto place(const MeasuredRun& run) {
  return std::tuple(phase_index(run.phase), run.algorithm);
}

// Parses a row; returns nothing unless `rows` has its algorithm and phase and it has the right number of
// columns.
std::optional<MeasuredRun> read_row(const std::vector<std::string>& cells,
                                    const std::vector<MeasuredRun>& rows) {
  const auto& of_hand = fields_of<MeasuredRun>();
  const auto& figures = fields_of<M>();
  const std::size_t algorithm = 1 + of_hand.size(), first = algorithm + 2;
  if (cells.size() != first + figures.size() + 1) return std::nullopt;
  const auto of = std::ranges::find_if(rows, [&](const MeasuredRun& row) {
    return cells[algorithm] == row.algorithm.name && cells[algorithm + 1] == row.phase;
  });
  if (of == rows.end()) return std::nullopt;
  const auto number = [&](std::size_t n) { return parse_number<double>(cells[n]).value_or(kNotMeasured); };
  MeasuredRun row{.algorithm = of->algorithm,
                  .phase = of->phase,
                  .metrics = {},
                  .not_reached = cells.back(),
                  .seed = parse_number<std::uint64_t>(cells[0]).value_or(0)};
  for (std::size_t n = 0; n < of_hand.size(); ++n) of_hand[n].set(row, number(1 + n));
  for (std::size_t n = 0; n < figures.size(); ++n) figures[n].set(row.metrics, number(first + n));
  return row;
}

// Ignores times, which depend on the machine.
bool same_figures(const MeasuredRun& a, const MeasuredRun& b) {
  return std::ranges::all_of(fields_of<M>(), [&](const Field<M>& figure) {
    const double first = figure.get(a.metrics), second = figure.get(b.metrics);
    return figure.has(kMachineDependent) || first == second || (std::isnan(first) && std::isnan(second));
  });
}

}  // namespace

std::vector<Field<RunMetrics>> key_metrics() {
  std::vector<Field<RunMetrics>> compared;
  for (const char* column :
       {"force_hp_rms_N", "force_hp_share", "force_step_max_N", "torque_hp_rms_Nmm", "torque_hp_share",
        "torque_step_max_Nmm", "torque_mean_Nmm", "shaft_spread_deg", "shaft_from_handle_deg", "removed_mm3",
        "removal_mm3_per_s", "tick_us_median", "tick_us_p99"})
    compared.push_back(metric(column));
  return compared;
}

std::string short_label(const AlgorithmId& algorithm) {
  return algorithm.label.substr(0, algorithm.label.find(' '));
}

Study::Study(std::vector<MeasuredRun> rows) : rows_(std::move(rows)) {
  const auto others = std::stable_partition(rows_.begin(), rows_.end(),
                                            [](const MeasuredRun& row) { return row.is_study_hand(); });
  extra_rows_.assign(others, rows_.end());
  rows_.erase(others, rows_.end());
  if (rows_.empty()) throw std::invalid_argument("study: there are no trials");
  std::map<std::uint64_t, std::size_t> order;
  for (const MeasuredRun& row : rows_) {
    if (order.emplace(row.seed, seeds_.size()).second) seeds_.push_back(row.seed);
  }
  std::stable_sort(rows_.begin(), rows_.end(), [&](const MeasuredRun& a, const MeasuredRun& b) {
    return std::tuple(order.at(a.seed), place(a)) < std::tuple(order.at(b.seed), place(b));
  });
  const std::size_t each = rows_.size() / seeds_.size();
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    const MeasuredRun& row = rows_[n];
    const bool again = n % each != 0 && place(row) == place(rows_[n - 1]);
    if (again || row.seed != seeds_[std::min(n / each, seeds_.size() - 1)] ||
        place(row) != place(rows_[n % each])) {
      throw std::invalid_argument(fmt::format("study: seed {} was not tried as the others were", row.seed));
    }
  }
}

std::span<const MeasuredRun> Study::rows_of_seed(std::size_t n) const {
  const std::size_t each = rows_.size() / seeds_.size();
  return std::span(rows_).subspan(n * each, each);
}

std::vector<AlgorithmId> Study::algorithms() const {
  std::vector<AlgorithmId> tried;
  for (const MeasuredRun& row : rows_) tried.push_back(row.algorithm);
  return sorted_unique(std::move(tried));
}

std::vector<std::string_view> Study::phases() const {
  std::vector<std::string_view> tried;
  for (const std::string_view phase : kPhases)
    if (std::ranges::any_of(rows_, [&](const MeasuredRun& row) { return row.phase == phase; }))
      tried.push_back(phase);
  return tried;
}

std::size_t Study::seeds_needed() const {
  const std::size_t algorithms = this->algorithms().size();
  const std::size_t pairs = std::max<std::size_t>(algorithms * (algorithms - 1) / 2, 1);
  std::size_t seeds = 1;
  while (static_cast<double>(pairs) * min_p(seeds) > kSignificance) ++seeds;
  return seeds;
}

std::vector<Field<RunMetrics>> Study::metrics_of(std::string_view phase) const {
  std::vector<Field<RunMetrics>> metrics = key_metrics();
  std::erase_if(metrics, [&](const Field<RunMetrics>& metric) {
    return std::none_of(rows_.begin(), rows_.end(), [&](const MeasuredRun& row) {
      const double value = metric.get(row.metrics);
      return row.phase == phase && value != 0 && !std::isnan(value);
    });
  });
  return metrics;
}

std::vector<double> Study::all_values(const AlgorithmId& algorithm, std::string_view phase,
                                      const RunFigure& figure) const {
  std::vector<double> values;
  for (const MeasuredRun& row : rows_) {
    if (place(row) == std::tuple(phase_index(phase), algorithm)) values.push_back(figure(row.metrics));
  }
  return values;
}

std::vector<double> Study::values(const AlgorithmId& algorithm, std::string_view phase,
                                  const RunFigure& figure) const {
  std::vector<double> values = all_values(algorithm, phase, figure);
  std::erase_if(values, [](double value) { return std::isnan(value); });
  return values;
}

std::vector<double> Study::values_by_tremor(const AlgorithmId& algorithm, std::string_view phase,
                                            const RunFigure& figure) const {
  std::vector<double> values;
  std::optional<std::uint64_t> hand;
  for (const MeasuredRun& row : extra_rows_) {
    if (row.other_tremor == 0 || place(row) != std::tuple(phase_index(phase), algorithm)) continue;
    values.push_back(figure(row.metrics));
    hand = row.seed;
  }
  for (const MeasuredRun& row : rows_) {
    if (row.seed == hand && place(row) == std::tuple(phase_index(phase), algorithm))
      values.push_back(figure(row.metrics));
  }
  std::erase_if(values, [](double value) { return std::isnan(value); });
  return values;
}

std::string Study::why_not_measured(const AlgorithmId& algorithm, std::string_view phase,
                                    const RunFigure& figure) const {
  std::vector<ContactShares> unmeasured;
  for (const MeasuredRun& row : rows_) {
    if (place(row) == std::tuple(phase_index(phase), algorithm) && std::isnan(figure(row.metrics)))
      unmeasured.push_back(row.metrics.contact);
  }
  return seeds_.size() == 1 && !unmeasured.empty() ? contact_words(unmeasured.front())
                                                   : contact_words(unmeasured, seeds_.size());
}

std::string Study::not_reached(const AlgorithmId& algorithm, std::string_view phase) const {
  // Separator of the parts of MeasuredRun::not_reached.
  constexpr std::string_view kBetween = "; ";
  std::map<std::string, std::size_t> hands;
  for (const MeasuredRun& row : rows_) {
    if (place(row) != std::tuple(phase_index(phase), algorithm)) continue;
    for (std::size_t from = 0; from < row.not_reached.size();) {
      const std::size_t to = std::min(row.not_reached.find(kBetween, from), row.not_reached.size());
      ++hands[row.not_reached.substr(from, to - from)];
      from = to + kBetween.size();
    }
  }
  std::string text;
  for (const auto& [words, count] : hands) {
    if (!text.empty()) text += kBetween;
    text += seeds_.size() == 1 ? words : fmt::format("{} ({} of {} hands)", words, count, seeds_.size());
  }
  return text;
}

std::vector<std::string> unreached_lines(const Study& study) {
  std::vector<std::string> lines;
  // The last phase also names everything that milling did not reach.
  const std::string_view last = study.phases().back();
  const auto count = [&](const std::vector<MeasuredRun>& rows, const AlgorithmId& algorithm, bool unreached) {
    return std::ranges::count_if(rows, [&](const MeasuredRun& row) {
      return row.algorithm == algorithm && row.phase == last && !(unreached && row.not_reached.empty());
    });
  };
  for (const AlgorithmId& algorithm : study.algorithms()) {
    const auto own = count(study.rows(), algorithm, true),
               beside = count(study.extra_rows(), algorithm, true);
    if (own + beside == 0) continue;
    std::string line = algorithm.name + ": ";
    if (own > 0 && study.seeds().size() > 1)
      line += fmt::format("{} of {} hands did not do all of the test: ", own, study.seeds().size());
    line += study.not_reached(algorithm, last);
    if (beside > 0)
      line += fmt::format("{}{} of {} trials with another grip or tremor did not do all of {}",
                          own > 0 ? "; " : "", beside, count(study.extra_rows(), algorithm, false),
                          own > 0 ? "it either" : "the test");
    lines.push_back(std::move(line));
  }
  return lines;
}

void write_study_csv(const std::filesystem::path& path, const Study& study) {
  write_text_atomically(path, [&](std::ostream& out) {
    out << columns() << '\n';
    for (const auto* rows : {&study.rows(), &study.extra_rows()}) {
      for (const MeasuredRun& row : *rows)
        out << row.seed << csv_values(fields_of<MeasuredRun>(), row) << ',' << summary_fields(row) << '\n';
    }
  });
}

std::vector<MeasuredRun> read_study_csv(const std::filesystem::path& path,
                                        const std::vector<MeasuredRun>& like) {
  std::vector<MeasuredRun> rows;
  for (const std::vector<std::string>& cells : read_csv_table(path, columns()))
    if (std::optional<MeasuredRun> row = read_row(cells, like)) rows.push_back(*std::move(row));
  return rows;
}

bool has_runs(const std::vector<MeasuredRun>& rows, const std::vector<MeasuredRun>& runs) {
  return std::ranges::all_of(runs, [&](const MeasuredRun& run) {
    return std::ranges::any_of(rows, [&](const MeasuredRun& row) {
      return row.is_study_hand() && row.seed == run.seed && place(row) == place(run) &&
             same_figures(row, run);
    });
  });
}

}  // namespace osteomill
