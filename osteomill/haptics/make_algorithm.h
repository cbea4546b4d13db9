#pragma once

#include <memory>

#include "osteomill/haptics/haptic_algorithm.h"
#include "osteomill/haptics/haptic_settings.h"

namespace osteomill {

/// The algorithm with these settings, still to be prepared. Throws std::invalid_argument, naming the setting,
/// where one is out of range.
std::unique_ptr<HapticAlgorithm> make_algorithm(AlgorithmId algorithm, const HapticSettings& settings);

}  // namespace osteomill
