#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "osteomill/experiment/study_design.h"
#include "osteomill/experiment/trial_rows.h"
#include "osteomill/report/html.h"

namespace osteomill {

/// Calls a function with every row of a study that there is, and with what was set of its trial.
using EachRow =
    std::function<void(const std::function<void(const StudySettings& settings, const TrialRow& row)>&)>;

/// Draws a map into `folder` as NAME.svg and NAME.png: a cell for each pair of values, or, of more than 40,
/// for each of 24 equal parts of their range. Nothing where no row has what it shows. Throws as draw_figure
/// does.
std::optional<CaptionedFigure> draw_study_map(const StudyDesign& design, const StudyMap& map,
                                              const EachRow& each_row, const std::string& name,
                                              const std::filesystem::path& folder);

}  // namespace osteomill
