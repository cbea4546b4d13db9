#pragma once

#include <string>
#include <vector>

namespace osteomill {

/// What can be poor of the paper's algorithms: a line for each is put behind `doubts`. Their settings keep
/// ranges in which all numbers are finite, since poor ones may be wanted for a comparison.

/// A spring so soft that a hand reaches no force, or so stiff that it cannot be held.
void doubt_stiffness(std::vector<std::string>& doubts, const std::string& setting, double N_per_mm);
/// So many densities read in a tick, at most, that it can take over a millisecond.
void doubt_reads(std::vector<std::string>& doubts, const std::string& settings, int reads);

}  // namespace osteomill
