#pragma once

#include <string>
#include <vector>

namespace osteomill {

/// These functions append a line to `warnings` for each poor setting of the paper's algorithms. The settings
/// keep ranges in which all numbers are finite, because poor ones may be wanted for a comparison.

/// Appends a line if the spring is so soft that a hand reaches no force, or so stiff that it cannot be held.
void add_stiffness_warning(std::vector<std::string>& warnings, const std::string& setting, double N_per_mm);
/// Appends a line if a tick may read enough densities (at most `reads`) to take over a millisecond.
void add_reads_warning(std::vector<std::string>& warnings, const std::string& settings, int reads);

}  // namespace osteomill
