#include "osteomill/experiment/study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <ostream>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "osteomill/experiment/paper.h"
#include "osteomill/experiment/signed_rank.h"
#include "osteomill/files/atomic_file.h"

namespace osteomill {

namespace {

constexpr double kMmPerM = 1000;

using M = RunMetrics;

// Phase before algorithm, as in summary.csv.
auto place(const MeasuredRun& run) {
  return std::tuple(run.mode, phase_number(run.segment), run.algorithm);
}

template <typename Values, typename Matches>
auto present(const Values& all, std::span<const StudyRow> rows, const Matches& matches) {
  std::vector<typename Values::value_type> found;
  for (const auto& value : all) {
    const auto has_it = [&](const StudyRow& row) { return matches(row.run, value); };
    if (std::any_of(rows.begin(), rows.end(), has_it)) found.push_back(value);
  }
  return found;
}

}  // namespace

std::vector<Metric> key_metrics() {
  std::vector<Metric> compared;
  std::copy_if(all_metrics().begin(), all_metrics().end(), std::back_inserter(compared),
               [](const Metric& metric) { return metric.compared > 0; });
  std::sort(compared.begin(), compared.end(),
            [](const Metric& a, const Metric& b) { return a.compared < b.compared; });
  return compared;
}

std::string short_label(const AlgorithmId& algorithm) {
  return algorithm.label.substr(0, algorithm.label.find(' '));
}

Study::Study(std::vector<StudyRow> rows) : rows_(std::move(rows)) {
  const auto others =
      std::stable_partition(rows_.begin(), rows_.end(), [](const StudyRow& row) { return row.grip == 1; });
  other_grips_.assign(others, rows_.end());
  rows_.erase(others, rows_.end());
  if (rows_.empty()) throw std::invalid_argument("study: there are no trials");
  std::map<std::uint64_t, std::size_t> order;
  for (const StudyRow& row : rows_) {
    if (order.emplace(row.seed, seeds_.size()).second) seeds_.push_back(row.seed);
  }
  std::stable_sort(rows_.begin(), rows_.end(), [&](const StudyRow& a, const StudyRow& b) {
    return std::tuple(order.at(a.seed), place(a.run)) < std::tuple(order.at(b.seed), place(b.run));
  });
  const std::size_t each = rows_.size() / seeds_.size();
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    const StudyRow& row = rows_[n];
    const bool again = n % each != 0 && place(row.run) == place(rows_[n - 1].run);
    if (again || row.seed != seeds_[std::min(n / each, seeds_.size() - 1)] ||
        place(row.run) != place(rows_[n % each].run)) {
      throw std::invalid_argument(fmt::format("study: seed {} was not tried as the others were", row.seed));
    }
  }
}

std::span<const StudyRow> Study::rows_of_seed(std::size_t n) const {
  const std::size_t each = rows_.size() / seeds_.size();
  return std::span(rows_).subspan(n * each, each);
}

std::vector<AlgorithmId> Study::algorithms() const {
  std::vector<AlgorithmId> tried;
  for (const StudyRow& row : rows_) tried.push_back(row.run.algorithm);
  return each_once(std::move(tried));
}

std::vector<Mode> Study::modes() const {
  return present(std::array{Mode::paper, Mode::steady}, rows_,
                 [](const MeasuredRun& r, Mode mode) { return r.mode == mode; });
}

std::vector<std::string_view> Study::phases() const {
  return present(kPhases, rows_,
                 [](const MeasuredRun& r, std::string_view phase) { return r.segment == phase; });
}

std::size_t Study::seeds_needed() const {
  const std::size_t algorithms = this->algorithms().size();
  const std::size_t pairs = std::max<std::size_t>(algorithms * (algorithms - 1) / 2, 1);
  std::size_t seeds = 1;
  while (static_cast<double>(pairs) * min_p(seeds) > kSignificance) ++seeds;
  return seeds;
}

std::vector<Metric> Study::metrics_of(std::string_view phase) const {
  std::vector<Metric> metrics = key_metrics();
  std::erase_if(metrics, [&](const Metric& metric) {
    return std::none_of(rows_.begin(), rows_.end(), [&](const StudyRow& row) {
      const double value = metric(row.run.metrics);
      return row.run.segment == phase && value != 0 && !std::isnan(value);
    });
  });
  return metrics;
}

bool Study::was_tried(const Tried& tried) const {
  return std::any_of(rows_.begin(), rows_.end(), [&](const StudyRow& row) {
    return row.run.mode == tried.mode && row.run.algorithm == tried.algorithm;
  });
}

std::vector<double> Study::all_values(const Tried& tried, std::string_view phase,
                                      const RunFigure& figure) const {
  std::vector<double> values;
  for (const StudyRow& row : rows_) {
    if (place(row.run) == std::tuple(tried.mode, phase_number(phase), tried.algorithm))
      values.push_back(figure(row.run.metrics));
  }
  return values;
}

std::vector<double> Study::values(const Tried& tried, std::string_view phase, const RunFigure& figure) const {
  std::vector<double> values = all_values(tried, phase, figure);
  std::erase_if(values, [](double value) { return std::isnan(value); });
  return values;
}

ContactShares Study::contact(const Tried& tried, std::string_view phase) const {
  const auto median = [&](const RunFigure& figure) {
    return distribution_of(values(tried, phase, figure)).median;
  };
  ContactShares shares;
  shares.any = median([](const M& m) { return m.contact.any; });
  shares.burr = median([](const M& m) { return m.contact.burr; });
  shares.shaft = median([](const M& m) { return m.contact.shaft; });
  shares.force = median([](const M& m) { return m.contact.force; });
  shares.torque = median([](const M& m) { return m.contact.torque; });
  const std::vector<double> lost = values(tried, phase, [](const M& m) { return m.contact.lost_after_s; });
  if (!lost.empty() && !are_most(seeds_.size() - lost.size()))
    shares.lost_after_s = distribution_of(lost).median;
  shares.lost_while_milling =
      median([](const M& m) { return m.contact.lost_while_milling ? 1.0 : 0.0; }) > 0.5;
  return shares;
}

std::pair<std::vector<double>, std::vector<double>> Study::paired_values(const Tried& first,
                                                                         const Tried& second,
                                                                         std::string_view phase,
                                                                         const RunFigure& figure) const {
  const std::vector<double> all_first = all_values(first, phase, figure);
  const std::vector<double> all_second = all_values(second, phase, figure);
  std::pair<std::vector<double>, std::vector<double>> pairs;
  for (std::size_t n = 0; n < std::min(all_first.size(), all_second.size()); ++n) {
    if (std::isnan(all_first[n]) || std::isnan(all_second[n])) continue;
    pairs.first.push_back(all_first[n]);
    pairs.second.push_back(all_second[n]);
  }
  return pairs;
}

void write_study_csv(const std::filesystem::path& path, const Study& study) {
  write_text_atomically(path, [&](std::ostream& out) {
    out << "seed,hand_stiffness_N_per_m,hand_damping_Ns_per_m," << summary_columns() << '\n';
    for (const StudyRow& row : study.rows()) {
      out << fmt::format("{},{},{},{}\n", row.seed, kMmPerM * row.hand.stiffness_N_per_mm,
                         kMmPerM * row.hand.damping_Ns_per_mm, summary_fields(row.run));
    }
  });
}

}  // namespace osteomill
