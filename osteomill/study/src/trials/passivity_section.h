#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "osteomill/study/figure.h"
#include "osteomill/study/measure_passivity.h"
#include "osteomill/study/page.h"

namespace osteomill {

/// Draws the stiffness felt at the limit over the device's damping, a panel for each delay, with the rule of
/// the ideal wall.
Figure draw_passivity_figure(std::span<const PassivityRow> rows, const std::filesystem::path& folder);

/// Returns the report's section on passivity against a flat wall: what was measured and how, in words, with
/// the figure and a table.
Section passivity_section(std::span<const PassivityRow> rows, const Figure& figure);

/// Returns the rows of stability.csv that are of these algorithms; none if there is no such table.
std::vector<PassivityRow> read_passivity_csv(const std::filesystem::path& path,
                                             const std::vector<AlgorithmId>& algorithms);

/// Writes stability.csv, whole or not at all. Throws InputError if it cannot be written.
void write_passivity_csv(const std::filesystem::path& path, std::span<const PassivityRow> rows);

}  // namespace osteomill
