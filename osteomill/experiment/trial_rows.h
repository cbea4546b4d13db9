#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/experiment/measure_passivity.h"
#include "osteomill/experiment/study.h"

namespace osteomill {

/// What each trial of a study does: section 8.2 of the paper in a simulated hand, which gives a row for each
/// phase; or a device without a hand is pressed on a flat wall (wall_press.h), one row.
enum class StudyTest : unsigned char { milling, wall };

inline constexpr std::string_view kStudyTests[] = {"milling", "wall"};
inline std::string_view name_of(StudyTest test) {
  return kStudyTests[static_cast<int>(test)];
}

/// The parts of a test, one row each.
std::span<const std::string_view> parts_of(StudyTest test);

/// A column of the rows of a test.
struct StudyColumn {
  std::string name;
  /// In words, with the unit.
  std::string label;
};
const std::vector<StudyColumn>& columns_of(StudyTest test);

/// A part of a trial as a slice's file has it: a value for each column, not a number where it could not be
/// measured, and what was not reached.
struct TrialRow {
  std::size_t trial = 0;
  std::size_t part = 0;
  std::vector<double> values;
  std::string not_reached;
};

/// Of trial 0.
TrialRow as_row(const StudyRow& row);
TrialRow as_row(const TrialSettings& settings, const WallPressResult& result);

/// A row of `milling` as it was before `as_row`, with the seed, algorithm and grip of `of`.
StudyRow milling_row(const TrialRow& row, StudyRow of = {});

}  // namespace osteomill
