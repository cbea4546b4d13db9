#pragma once

#include <string_view>

#include "osteomill/session/milling_setup.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// The option of every setting by which an algorithm is made stiffer or softer (SettingDescription::option).
inline constexpr std::string_view kStiffnessOption = "stiffness";

/// Returns how stiff the setup's algorithm is felt on a flat wall (flat_wall) with its haptic settings: the
/// slope of the force over the depth about 0.5 N (press_slowly_on_wall). 0 if it does not carry that force.
/// Throws std::invalid_argument if a setting is out of range.
double felt_stiffness_N_per_mm(const MillingSetup& setup, const Volume& wall);

/// Returns the value of the algorithm's setting of the option "stiffness", as a setting of that algorithm
/// alone, with which it is felt as `felt_N_per_mm`, within 1 %. Sought from its value in `setup` within 0.05
/// to 200 and the setting's range. Throws std::invalid_argument, naming the algorithm, if it has no such
/// setting or none is found: it may be too stiff or too soft, or, if its force rises in steps, leap from one
/// slope to another.
HapticSettings::Named setting_felt_as(double felt_N_per_mm, MillingSetup setup, const Volume& wall);

}  // namespace osteomill
