#pragma once

#include <string>
#include <vector>

#include "osteomill/study/study_design.h"

namespace osteomill::app {

/// The design that a study's file describes (docs/studies.md). Throws InputError, naming the file and the
/// line, if it is no TOML, has a key that neither a study nor a trial (`keys`) has, or an axis without
/// values.
StudyDesign read_study_file(const std::string& file, const std::vector<std::string>& keys);

}  // namespace osteomill::app
