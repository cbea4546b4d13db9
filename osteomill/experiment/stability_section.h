#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "osteomill/experiment/measure_stability.h"
#include "osteomill/report/figure.h"

namespace osteomill {

/// The report's section on stability against a flat wall: what was measured and how, in words, with the
/// figure and a table. HTML. Throws InputError where the figure cannot be read.
std::string stability_section(std::span<const StabilityRow> rows, const Figure& figure);

/// Writes stability.csv, whole or not at all. Throws InputError where it cannot be written.
void write_stability_csv(const std::filesystem::path& path, std::span<const StabilityRow> rows);

}  // namespace osteomill
