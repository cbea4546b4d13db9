#pragma once

#include <filesystem>

#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// Writes the densities as gzip-compressed NRRD in the patient's frame (LPS, mm), so that `read_scan`
/// restores them exactly. Stores 16-bit integers if all values are whole and fit, otherwise floats. Writes
/// the file atomically. Throws InputError, naming the file, if it cannot be written.
void write_nrrd(const std::filesystem::path& path, const DensityGrid& grid);

}  // namespace osteomill
