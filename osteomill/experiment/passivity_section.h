#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "osteomill/experiment/measure_passivity.h"
#include "osteomill/report/figure.h"

namespace osteomill {

/// The report's section on stability against a flat wall: what was measured and how, in words, with the
/// figure and a table. HTML. Throws InputError where the figure cannot be read.
std::string passivity_section(std::span<const PassivityRow> rows, const Figure& figure);

/// Writes stability.csv, whole or not at all. Throws InputError where it cannot be written.
void write_passivity_csv(const std::filesystem::path& path, std::span<const PassivityRow> rows);

}  // namespace osteomill
