#pragma once

#include <string>
#include <vector>

#include "osteomill/study/study_design.h"

namespace osteomill::app {

/// Reads the design in a study file (docs/studies.md). Throws InputError, naming the file and the line, if it
/// is not TOML, has a key that is unknown for studies and trials (`keys`), or an axis without values.
StudyDesign read_study_file(const std::string& file, const std::vector<std::string>& keys);

}  // namespace osteomill::app
