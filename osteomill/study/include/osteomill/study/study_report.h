#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "osteomill/study/study_design.h"
#include "osteomill/study/study_slices.h"

namespace osteomill {

/// The treatment, by `write_study_report`, of trials that did not do all of their test
/// (MeasuredRun::not_reached): counted with the others and marked, or left out.
enum class Unreached : unsigned char { marked, dropped };

/// Writes into the folder's report/ what the study's slices hold so far: trials.csv, a row for each part of
/// each trial (docs/studies.md), and report.html with the design's maps and, where it asks for them, the
/// paper's findings; both say what share of the study they are of, and how many trials did not do all of
/// their test. Whole or not at all. Returns the page's path. Throws InputError if no trial is done, a map
/// has nothing to show, or writing fails.
std::filesystem::path write_study_report(const StudyDesign& design, const StudyFolder& study,
                                         Unreached unreached = Unreached::marked);

/// Returns the head of a study's list of trials, "trial,algorithm,push (N)": what varies.
std::string list_head(const StudyDesign& design);
/// Returns the row of the trial of this number, from 0, in that list.
std::string list_row(const StudyDesign& design, std::size_t number);

}  // namespace osteomill
