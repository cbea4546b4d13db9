#pragma once

#include <string>
#include <utility>
#include <vector>

#include "verification/section.h"

namespace osteomill::verification {

/// Measured sections with their names on the command line, in the order of the page.
using MeasuredSections = std::vector<std::pair<std::string, Section>>;

/// Returns the head of docs/verification.md: an introduction; for each question its sections, the number of
/// rows that hold, and reservations; and the rows that miss.
std::string summary(const MeasuredSections& measured);

}  // namespace osteomill::verification
