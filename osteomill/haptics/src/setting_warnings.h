#pragma once

#include <string>
#include <vector>

namespace osteomill {

/// These functions warn of poor settings of the paper's algorithms. The settings' ranges only keep numbers
/// finite, because poor values may be wanted for a comparison.

/// Appends a line if the spring is too soft for a hand to reach a force, or too stiff to be held.
void add_stiffness_warning(std::vector<std::string>& warnings, const std::string& setting, double N_per_mm);
/// Appends a line if a tick may read enough densities (at most `reads`) to take over a millisecond.
void add_reads_warning(std::vector<std::string>& warnings, const std::string& settings, int reads);

}  // namespace osteomill
