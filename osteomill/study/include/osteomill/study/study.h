#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "osteomill/study/metric_table.h"

namespace osteomill {

/// Returns the figures to compare: force, torque, shaft, bone removed and compute time, in reading order.
std::vector<Field<RunMetrics>> key_metrics();

/// Quantity by which runs are compared: a figure, or anything else computed from a run's figures.
using RunFigure = std::function<double(const RunMetrics&)>;

/// Returns the first word of an algorithm's label, where space is short: "1" of "1 line-proxy".
std::string short_label(const AlgorithmId& algorithm);

/// Trials of several algorithms, repeated with many seeds, each seed being a different hand, so that
/// algorithms can be compared seed by seed.
class Study {
 public:
  /// Takes rows in any order; those of other grips and tremors are kept separately. Throws
  /// std::invalid_argument if there are none, or if a seed lacks an algorithm and phase that another has, or
  /// has it twice.
  explicit Study(std::vector<MeasuredRun> rows);

  /// Returns the rows by seed, in the order of first appearance; within a seed as in summary.csv.
  const std::vector<MeasuredRun>& rows() const { return rows_; }
  /// Returns the rows of hands in other grips and with other tremors.
  const std::vector<MeasuredRun>& extra_rows() const { return extra_rows_; }
  const std::vector<std::uint64_t>& seeds() const { return seeds_; }
  /// Returns the rows of the n-th seed.
  std::span<const MeasuredRun> rows_of_seed(std::size_t n) const;

  /// Returns the algorithms that were tried, in the paper's order.
  std::vector<AlgorithmId> algorithms() const;
  std::vector<std::string_view> phases() const;

  /// Returns the smallest number of seeds with which a difference between two of the study's algorithms can
  /// be significant.
  std::size_t seeds_needed() const;

  /// Returns the key metrics except for those that are zero throughout a phase (bone removed while holding).
  std::vector<Field<RunMetrics>> metrics_of(std::string_view phase) const;

  /// Returns the figure's values, one per seed in the order of `seeds`, NaN if there was too little contact
  /// to measure it; empty if the algorithm was not tried.
  std::vector<double> all_values(const AlgorithmId& algorithm, std::string_view phase,
                                 const RunFigure& figure) const;
  /// Returns those of `all_values` that are numbers.
  std::vector<double> values(const AlgorithmId& algorithm, std::string_view phase,
                             const RunFigure& figure) const;
  /// Returns the figure's values in the runs of one hand that differ only in tremor; empty if no other
  /// tremors were tried.
  std::vector<double> values_by_tremor(const AlgorithmId& algorithm, std::string_view phase,
                                       const RunFigure& figure) const;
  /// Returns why the figure could not be measured (contact_words), with the number of hands for each reason
  /// if there are several hands; empty if it was measured in all.
  std::string why_not_measured(const AlgorithmId& algorithm, std::string_view phase,
                               const RunFigure& figure) const;
  /// Returns which parts of the plan were not completed (MeasuredRun::not_reached), and in how many hands if
  /// there are several; empty if all were.
  std::string not_reached(const AlgorithmId& algorithm, std::string_view phase) const;
  /// Returns whether this number of seeds is more than half of all.
  bool are_most(std::size_t seeds) const { return 2 * seeds > seeds_.size(); }

 private:
  std::vector<MeasuredRun> rows_;
  std::vector<MeasuredRun> extra_rows_;
  std::vector<std::uint64_t> seeds_;
};

/// Returns a line for each algorithm that did not complete the test in some of the hands or extra trials: in
/// how many, and what it did not complete.
std::vector<std::string> unreached_lines(const Study& study);

/// Writes study.csv atomically: seed, the hand's stiffness (N/m) and damping (N s/m), its grip, the number of
/// another tremor, and the columns of summary.csv; rows of other grips and tremors last. Throws InputError if
/// it cannot be written.
void write_study_csv(const std::filesystem::path& path, const Study& study);

/// Reads the rows of a table from `write_study_csv` that have the algorithms and phases of `like`; returns
/// none if there is no such table.
std::vector<MeasuredRun> read_study_csv(const std::filesystem::path& path,
                                        const std::vector<MeasuredRun>& like);

/// Returns whether all these runs are among the rows, with the same figures except for times.
bool has_runs(const std::vector<MeasuredRun>& rows, const std::vector<MeasuredRun>& runs);

}  // namespace osteomill
