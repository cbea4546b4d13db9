#pragma once

#include <memory>
#include <vector>

#include "osteomill/haptics/haptic_algorithm.h"
#include "osteomill/haptics/haptic_settings.h"
#include "osteomill/haptics/setting_fields.h"

namespace osteomill {

/// The algorithm with these settings, still to be prepared. Throws std::invalid_argument, naming the setting,
/// where one is out of range or unknown.
std::unique_ptr<HapticAlgorithm> make_algorithm(AlgorithmId algorithm, const HapticSettings& settings);

/// Every setting with which `make_algorithm` makes the algorithm, by its own name, switches among them.
std::vector<SettingValue> describe_algorithm(AlgorithmId algorithm, const HapticSettings& settings);

}  // namespace osteomill
