#pragma once

#include <filesystem>

#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// Writes the densities as NRRD, gzip-compressed, in the patient's frame (LPS, mm), so that `read_scan`
/// returns every density and its place. Values are stored as 16-bit integers if all are whole and fit, else
/// as floats. The file appears whole or not at all. Throws InputError, naming the file, if it cannot be
/// written.
void write_nrrd(const std::filesystem::path& path, const DensityGrid& grid);

}  // namespace osteomill
