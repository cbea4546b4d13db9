#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/study/measure_passivity.h"
#include "osteomill/study/study.h"

namespace osteomill {

/// The test that each trial of a study runs: section 8.2 of the paper in a simulated hand, which gives a row
/// for each phase; or a device without a hand is pressed on a flat wall (wall_press.h), one row.
enum class StudyTest : unsigned char { milling, wall };

/// The names of the tests, in their order.
inline constexpr std::string_view kStudyTests[] = {"milling", "wall"};
/// Returns the name of a test, as files of studies have it.
inline std::string_view name_of(StudyTest test) {
  return kStudyTests[static_cast<int>(test)];
}

/// Returns the names of a test's parts, one row each.
std::span<const std::string_view> parts_of(StudyTest test);

/// The figures of a press on a wall, as a TrialRow has them.
struct WallFigures {
  /// 1 if the handle came to rest; not a number if the wall gave way.
  double passive = kNotMeasured;
  /// 1 if the wall carried the force.
  double carries = 0;
  /// WallPressResult::felt_N_per_mm.
  double felt_N_per_mm = kNotMeasured;
  /// The greatest stiffness of an ideal wall there (passive_stiffness_rule_N_per_mm).
  double rule_N_per_mm = 0;
};
/// Returns the figures of a press with these settings.
WallFigures wall_figures(const TrialSettings& settings, const WallPressResult& result);

/// A part of a trial: of `milling` a run, of `wall` a press.
struct TrialRow {
  std::size_t trial = 0;
  std::size_t part = 0;
  MeasuredRun run = {};
  WallFigures wall = {};
};

/// Returns the numbers of a test's rows: of `milling` the hand and every figure of its run.
const std::vector<Field<TrialRow>>& columns_of(StudyTest test);

}  // namespace osteomill
