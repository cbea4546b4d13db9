#pragma once

#include <string_view>

#include "osteomill/session/milling_setup.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Option of the setting that makes an algorithm stiffer or softer (SettingDescription::option).
inline constexpr std::string_view kStiffnessOption = "stiffness";

/// Returns the stiffness felt with the setup's algorithm on a flat wall (flat_wall), with its haptic
/// settings: the slope of the force over the depth at 0.5 N (press_slowly_on_wall), N/mm. 0 if the wall does
/// not carry that force. Throws std::invalid_argument if a setting is out of range.
double felt_stiffness_N_per_mm(const MillingSetup& setup, const Volume& wall);

/// Finds the value of the algorithm's "stiffness" option with which it is felt as `felt_N_per_mm`, within 1
/// %, and returns it as a setting of that algorithm only. Searches from its value in `setup`, within 0.05 to
/// 200 and the setting's range. Throws std::invalid_argument, naming the algorithm, if it has no such setting
/// or no value is found: it may be too stiff or too soft, or its slope may jump if its force rises in steps.
HapticSettings::Named match_felt_stiffness(double felt_N_per_mm, MillingSetup setup, const Volume& wall);

}  // namespace osteomill
