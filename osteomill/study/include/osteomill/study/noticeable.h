#pragma once

#include <string>

#include "osteomill/base/field.h"

namespace osteomill {

/// Returns the least difference between two values of this size that a hand notices: 7 % of a force (Pang,
/// Tan and Durlach 1991), 13 % of a torque (Jandura and Srinivasan 1994), 20 % of what trembles above 20 Hz
/// (Forta, Griffin and Morioka 2012) and 2 degrees of the shaft's direction, as of the wrist's (Tan et al.
/// 1994). 0 for a figure that no hand feels, as bone removed or time. `value` has the figure's unit.
double least_noticeable(const FieldDescription& figure, double value);

/// Returns a sentence on these thresholds and their sources.
std::string about_noticeable();

}  // namespace osteomill
