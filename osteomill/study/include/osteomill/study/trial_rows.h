#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/study/measure_passivity.h"
#include "osteomill/study/study.h"

namespace osteomill {

/// Test that each trial of a study runs: section 8.2 of the paper with a simulated hand, one row per phase;
/// or a device without a hand pressed on a flat wall (wall_press.h), one row.
enum class StudyTest : unsigned char { milling, wall };

/// Names of the tests, in the order of StudyTest.
inline constexpr std::string_view kStudyTests[] = {"milling", "wall"};
/// Returns the name of a test, as used in study files.
inline std::string_view name_of(StudyTest test) {
  return kStudyTests[static_cast<int>(test)];
}

/// Returns the names of a test's parts, one row each.
std::span<const std::string_view> parts_of(StudyTest test);

/// Figures of a press on a wall, for a TrialRow.
struct WallFigures {
  /// 1 if the handle came to rest; NaN if the wall gave way.
  double passive = kNotMeasured;
  /// 1 if the wall carried the force.
  double carries = 0;
  /// WallPressResult::felt_N_per_mm.
  double felt_N_per_mm = kNotMeasured;
  /// Largest passive stiffness of an ideal wall there (passive_stiffness_rule_N_per_mm).
  double rule_N_per_mm = 0;
};
/// Returns the figures of a press with these settings.
WallFigures wall_figures(const TrialSettings& settings, const WallPressResult& result);

/// Result of one part of a trial: a run for `milling`, a press for `wall`.
struct TrialRow {
  std::size_t trial = 0;
  std::size_t part = 0;
  MeasuredRun run = {};
  WallFigures wall = {};
};

/// Returns the numeric fields of a test's rows: for `milling` the hand and every figure of its run.
const std::vector<Field<TrialRow>>& columns_of(StudyTest test);

}  // namespace osteomill
