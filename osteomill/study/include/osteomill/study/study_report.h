#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "osteomill/study/study_design.h"
#include "osteomill/study/study_slices.h"

namespace osteomill {

/// How `write_study_report` treats trials that did not complete their test (MeasuredRun::not_reached):
/// included and marked, or left out.
enum class Unreached : unsigned char { marked, dropped };

/// Writes the results of the finished slices into the folder's report/: trials.csv, a row for each part of
/// each trial (docs/studies.md), and report.html with the design's maps and, if requested, the paper's
/// findings. Both state the fraction of the study that is done, and how many trials did not complete their
/// test. Writes all files or none. Returns the page's path. Throws InputError if no trial is done, a map has
/// nothing to show, or writing fails.
std::filesystem::path write_study_report(const StudyDesign& design, const StudyFolder& study,
                                         Unreached unreached = Unreached::marked);

/// Returns the header of a study's list of trials, with the varying options: "trial,algorithm,push (N)".
std::string list_head(const StudyDesign& design);
/// Returns the row for this trial, numbered from 0, in that list.
std::string list_row(const StudyDesign& design, std::size_t number);

}  // namespace osteomill
