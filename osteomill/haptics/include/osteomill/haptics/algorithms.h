#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "osteomill/haptics/algorithm_description.h"

namespace osteomill {

/// Returns the project's algorithms, sorted by label: the paper's three as published, and our own. To add
/// one, create a folder and add a line to algorithms.cpp.
const std::vector<AlgorithmDescription>& all_algorithms();

/// Returns the names of `all_algorithms()`, in the same order.
const std::vector<std::string>& algorithm_names();

/// Returns the algorithm with this name; null if there is none.
const AlgorithmDescription* find_algorithm(std::string_view name);

/// Returns the algorithm with this name. Throws std::invalid_argument if there is none.
const AlgorithmDescription& algorithm_named(std::string_view name);

/// Returns the default algorithm: barrier-shell.
const AlgorithmDescription& default_algorithm();

}  // namespace osteomill
