#pragma once

#include <string>
#include <utility>
#include <vector>

#include "verification/section.h"

namespace osteomill::verification {

/// Holds the sections that were measured, each with its name on the command line, in the order of the page.
using MeasuredSections = std::vector<std::pair<std::string, Section>>;

/// Returns the head of docs/verification.md: how to read it, and for each question its sections, how many of
/// their rows hold, with which reservations, and which miss.
std::string summary(const MeasuredSections& measured);

}  // namespace osteomill::verification
