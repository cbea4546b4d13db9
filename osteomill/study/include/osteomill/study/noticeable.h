#pragma once

#include <string>

#include "osteomill/base/field.h"

namespace osteomill {

/// Returns the smallest difference from `value` that a hand notices, by the thresholds that
/// `about_noticeable` lists. 0 for a figure that a hand cannot feel, such as bone removed or time. `value`
/// has the figure's unit.
double least_noticeable(const FieldDescription& figure, double value);

/// Returns a paragraph with these thresholds and their sources.
std::string about_noticeable();

}  // namespace osteomill
