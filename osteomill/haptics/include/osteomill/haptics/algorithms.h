#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "osteomill/haptics/algorithm_description.h"

namespace osteomill {

/// Returns the project's algorithms, in the order of their labels: the paper's three as published, and our
/// own. One that is added is a folder and a line in algorithms.cpp.
const std::vector<AlgorithmDescription>& all_algorithms();

/// Returns the names of all.
const std::vector<std::string>& algorithm_names();

/// Returns the algorithm of that name; null if there is none.
const AlgorithmDescription* find_algorithm(std::string_view name);

/// Returns the algorithm of that name. Throws std::invalid_argument if there is none.
const AlgorithmDescription& algorithm_named(std::string_view name);

/// Returns the algorithm that is used if the user does not choose: barrier-shell.
const AlgorithmDescription& default_algorithm();

}  // namespace osteomill
