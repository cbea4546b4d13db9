#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "osteomill/study/trial_rows.h"

namespace osteomill {

/// Options of a trial and their values, as a command line would have them: {"push", "1.5"}.
using StudySettings = std::vector<std::pair<std::string, std::string>>;

/// Returns the value of an option, the last if it is set several times; null if it is not set.
const std::string* find_value(const StudySettings& settings, std::string_view key);

/// The settings that are tried, one after the other: each is a value of one option, or of several that belong
/// together (a tool, a hand).
using StudyAxis = std::vector<StudySettings>;

/// A number's range that is gone through evenly or, if `logarithmic`, evenly in its logarithm (steps_of()).
struct StudyRange {
  double from = 0;
  double to = 0;
  bool logarithmic = false;
  /// Returns the number at a share of the range, 0 its beginning and 1 its end.
  double at(double share) const;
};

/// Returns `steps` values from the range's beginning to its end. Throws std::invalid_argument if there are
/// none.
std::vector<double> steps_of(const StudyRange& range, std::size_t steps);

/// Trials spread over several options at once (McKay, Beckman and Conover 1979): for `trials` trials each
/// option's range is cut into as many parts of equal size, and each part is tried in exactly one trial, at a
/// place drawn within it.
struct LatinHypercube {
  /// One option: a range, or, if that is empty, one of several values, each as often as the others.
  struct Axis {
    std::string key;
    StudyRange range;
    StudyAxis values;
  };
  std::size_t trials = 0;
  std::uint64_t seed = 1;
  std::vector<Axis> axes;
};

/// A map of a study: the trials by two of their settings or results, coloured by a third. `x`, `y` and
/// `colour` are an option, a column of the rows, or the ratio of two of them, "A / B"; `panels` is an option,
/// or two in the same way, with a panel for each value.
struct StudyMap {
  std::string title;
  std::string x;
  std::string y;
  std::string colour;
  std::string panels = "algorithm";
  /// The part of the test whose rows are shown; empty for the first.
  std::string part;
  /// The statistic over the trials of a cell: "median", "mean" or "max".
  std::string statistic = "median";
  bool logarithmic_colour = false;
  /// Whether to draw a line along which x and y are the same.
  bool line_of_equality = false;
};

/// Returns the names in what a map shows: one, or the two of a ratio.
std::vector<std::string> names_in(std::string_view shown);

/// The trials of a study: every combination of the hypercube's trials and the grid's axes, numbered from 0,
/// the hypercube the slowest, so that a part of it is spread over all, and the last axis the fastest. A value
/// type; its trials are made from their numbers as they are needed, so that a million take no memory.
class StudyDesign {
 public:
  /// Throws std::invalid_argument, with one line, if an axis is empty or there are more than 1e7 trials.
  StudyDesign(StudySettings fixed, std::vector<StudyAxis> grid, LatinHypercube hypercube);

  std::size_t trial_count() const { return count_; }
  /// Returns all settings of a trial: those that are fixed, and those that vary in the order of `varied`.
  StudySettings trial(std::size_t number) const;
  /// Returns the options that differ between trials, in the order of the axes.
  const std::vector<std::string>& varied() const { return varied_; }
  /// Returns an option with its unit: "push (N)".
  std::string label_of(const std::string& option) const;

  std::string title;
  StudyTest test = StudyTest::milling;
  std::vector<StudyMap> maps;
  /// The paper's findings are held against the rows, hand by hand (of `milling`).
  bool findings = false;
  /// The units of options, for axes and tables.
  StudySettings units;

 private:
  StudySettings fixed_;
  std::vector<StudyAxis> grid_;
  LatinHypercube hypercube_;
  // For each of its axes, which part is tried in which trial.
  std::vector<std::vector<std::uint32_t>> parts_;
  std::vector<std::string> varied_;
  std::size_t count_ = 1;
};

/// Returns the seed of a trial; 1 if it is not set.
std::uint64_t seed_of(const StudySettings& settings);

}  // namespace osteomill
