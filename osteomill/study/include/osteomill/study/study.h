#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "osteomill/study/metric_table.h"

namespace osteomill {

/// Returns what is compared: force, torque, shaft, bone removed and compute time, in the order in which
/// people should read them.
std::vector<Field<RunMetrics>> key_metrics();

/// What runs are compared by: a figure, or anything else that follows from a run's figures.
using RunFigure = std::function<double(const RunMetrics&)>;

/// The first word of an algorithm's label, for narrow places: "1" of "1 line-proxy".
std::string short_label(const AlgorithmId& algorithm);

/// The same trials with many seeds, each in a hand of its own, so that algorithms can be compared seed
/// by seed.
class Study {
 public:
  /// Rows in any order; those of other grips are kept apart. Throws std::invalid_argument where there are
  /// none, or where a seed lacks an algorithm and phase that another has, or has it twice.
  explicit Study(std::vector<MeasuredRun> rows);

  /// By seed, in the order in which seeds first came; within a seed as in summary.csv.
  const std::vector<MeasuredRun>& rows() const { return rows_; }
  const std::vector<MeasuredRun>& rows_of_other_grips() const { return other_grips_; }
  const std::vector<std::uint64_t>& seeds() const { return seeds_; }
  /// The rows of the n-th seed.
  std::span<const MeasuredRun> rows_of_seed(std::size_t n) const;

  /// What was tried, in the paper's order.
  std::vector<AlgorithmId> algorithms() const;
  std::vector<std::string_view> phases() const;

  /// The fewest seeds from which a difference between two of so many algorithms can be significant.
  std::size_t seeds_needed() const;

  /// The key metrics but those that are zero throughout a phase (bone removed while holding).
  std::vector<Field<RunMetrics>> metrics_of(std::string_view phase) const;

  /// The figure's values, one a seed in the order of `seeds`, not a number where there was not enough contact
  /// to measure it; none if that was not tried.
  std::vector<double> all_values(const AlgorithmId& algorithm, std::string_view phase,
                                 const RunFigure& figure) const;
  /// Those that are numbers.
  std::vector<double> values(const AlgorithmId& algorithm, std::string_view phase,
                             const RunFigure& figure) const;
  /// For how much of the phase the tool touched: medians of the seeds. `lost_after_s` is that of those which
  /// lost contact, where they are no fewer than half.
  ContactShares contact(const AlgorithmId& algorithm, std::string_view phase) const;
  /// What of its plan was not reached (MeasuredRun::not_reached), and in how many hands where there are
  /// several; empty for nothing.
  std::string not_reached(const AlgorithmId& algorithm, std::string_view phase) const;
  /// Whether so many seeds are enough to speak of them all: more than half.
  bool are_most(std::size_t seeds) const { return 2 * seeds > seeds_.size(); }

 private:
  std::vector<MeasuredRun> rows_;
  std::vector<MeasuredRun> other_grips_;
  std::vector<std::uint64_t> seeds_;
};

/// Writes study.csv: seed, the hand's stiffness (N/m) and damping (N s/m), its grip, and the columns of
/// summary.csv; rows of other grips last. Whole or not at all. Throws InputError where it cannot be written.
void write_study_csv(const std::filesystem::path& path, const Study& study);

/// The study of these rows, of one seed, with the other hands and grips that `path` has of it: nothing where
/// there is no such file, or where it is not of these rows' figures.
std::optional<Study> read_study_csv(const std::filesystem::path& path, const std::vector<MeasuredRun>& rows);

}  // namespace osteomill
