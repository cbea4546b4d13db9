#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/study/page.h"
#include "osteomill/study/study_design.h"
#include "osteomill/study/trial_rows.h"

namespace osteomill {

/// Draws a map of a study's rows into `folder` as NAME.svg and NAME.png: a cell for each pair of values or,
/// for an axis with more than 40 values, for each of 24 equal parts of its range. Returns nothing if no row
/// has the values to show. Throws as draw_figure.
std::optional<CaptionedFigure> draw_study_map(const StudyDesign& design, const StudyMap& map,
                                              const std::vector<TrialRow>& rows, const std::string& name,
                                              const std::filesystem::path& folder);

}  // namespace osteomill
