#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "osteomill/study/figure.h"
#include "osteomill/study/measure_passivity.h"
#include "osteomill/study/page.h"

namespace osteomill {

/// Draws the felt stiffness at the limit against the device's damping, with a panel for each delay, and the
/// rule for an ideal wall.
Figure draw_passivity_figure(std::span<const PassivityRow> rows, const std::filesystem::path& folder);

/// Returns the report's section on passivity against a flat wall: what was measured and how, with the figure
/// and a table.
Section passivity_section(std::span<const PassivityRow> rows, const Figure& figure);

/// Reads the rows of stability.csv for these algorithms; returns none if there is no such table.
std::vector<PassivityRow> read_passivity_csv(const std::filesystem::path& path,
                                             const std::vector<AlgorithmId>& algorithms);

/// Writes stability.csv atomically. Throws InputError if it cannot be written.
void write_passivity_csv(const std::filesystem::path& path, std::span<const PassivityRow> rows);

}  // namespace osteomill
