#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/haptics/algorithm_description.h"

namespace osteomill {

/// The project's algorithms, in the order of their labels: the paper's three as published, and our own. One
/// that is added is a folder and a line in algorithms.cpp.
const std::vector<AlgorithmDescription>& all_algorithms();

/// The names of all.
const std::vector<std::string>& algorithm_names();

/// Null where there is none of that name.
const AlgorithmDescription* find_algorithm(std::string_view name);

/// The one of that name. Throws std::invalid_argument where there is none.
const AlgorithmDescription& algorithm_named(std::string_view name);

/// The one that is used where nobody chose: barrier-shell.
const AlgorithmDescription& default_algorithm();

/// The same as make_algorithm of its description.
std::unique_ptr<HapticAlgorithm> make_algorithm(std::string_view name, const HapticSettings& settings);

}  // namespace osteomill
