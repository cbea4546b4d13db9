#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "osteomill/study/trial_rows.h"

namespace osteomill {

/// Options of a trial and their values, as on a command line: {"push", "1.5"}.
using StudySettings = std::vector<std::pair<std::string, std::string>>;

/// Returns the value of an option, the last if it is set several times; null if it is not set.
const std::string* find_value(const StudySettings& settings, std::string_view key);

/// Settings to try in turn: each sets one option, or several that belong together (a tool, a hand).
using StudyAxis = std::vector<StudySettings>;

/// Range of a number, divided evenly or, if `logarithmic`, evenly in the logarithm (steps_of()).
struct StudyRange {
  double from = 0;
  double to = 0;
  bool logarithmic = false;
  /// Returns the number at a fraction of the range: 0 is its beginning, 1 its end.
  double at(double share) const;
};

/// Returns `steps` values from the beginning of the range to its end. Throws std::invalid_argument if `steps`
/// is 0.
std::vector<double> steps_of(const StudyRange& range, std::size_t steps);

/// Latin hypercube sampling of several options at once (McKay, Beckman and Conover 1979): each option's range
/// is divided into `trials` equal parts, and each part is used in exactly one trial, at a random position
/// within it.
struct LatinHypercube {
  /// An option: a range or, if that is empty, one of several values, all equally frequent.
  struct Axis {
    std::string key;
    StudyRange range;
    StudyAxis values;
  };
  std::size_t trials = 0;
  std::uint64_t seed = 1;
  std::vector<Axis> axes;
};

/// A map of a study: the trials over two of their settings or results, coloured by a third. `x`, `y` and
/// `colour` are an option, a column of the rows, or the ratio of two of them, "A / B". `panels` is an option,
/// or two, "A / B", with a panel for each value or pair of values.
struct StudyMap {
  std::string title;
  std::string x;
  std::string y;
  std::string colour;
  std::string panels = "algorithm";
  /// Part of the test whose rows are shown; empty for the first.
  std::string part;
  /// Statistic over the trials of a cell: "median", "mean" or "max".
  std::string statistic = "median";
  bool logarithmic_colour = false;
  /// Whether to draw the line x = y.
  bool line_of_equality = false;
};

/// Returns the names in an expression of a map: one, or the two of a ratio.
std::vector<std::string> operands_of(std::string_view shown);

/// The trials of a study: every combination of the hypercube's trials and the grid's axes, numbered from 0.
/// The hypercube varies slowest, so that a consecutive part of the study is spread over its ranges, and the
/// last axis fastest. Creates trials from their numbers on demand, so that a million take no memory.
class StudyDesign {
 public:
  /// Throws std::invalid_argument, with one line, if an axis is empty or there are more than 1e7 trials.
  StudyDesign(StudySettings fixed, std::vector<StudyAxis> grid, LatinHypercube hypercube);

  std::size_t trial_count() const { return count_; }
  /// Returns all settings of a trial: the fixed ones, then the varying ones in the order of `varied`.
  StudySettings trial(std::size_t number) const;
  /// Returns the options that differ between trials, in the order of the axes.
  const std::vector<std::string>& varied() const { return varied_; }
  /// Returns an option with its unit: "push (N)".
  std::string label_of(const std::string& option) const;

  std::string title;
  StudyTest test = StudyTest::milling;
  std::vector<StudyMap> maps;
  /// Whether the paper's findings are tested on the rows, hand by hand (`milling` only).
  bool findings = false;
  /// Units of options, for axes and tables.
  StudySettings units;

 private:
  StudySettings fixed_;
  std::vector<StudyAxis> grid_;
  LatinHypercube hypercube_;
  // For each axis of the hypercube, the part used in each trial.
  std::vector<std::vector<std::uint32_t>> parts_;
  std::vector<std::string> varied_;
  std::size_t count_ = 1;
};

/// Returns the seed of a trial; 1 if none is set.
std::uint64_t seed_of(const StudySettings& settings);

}  // namespace osteomill
