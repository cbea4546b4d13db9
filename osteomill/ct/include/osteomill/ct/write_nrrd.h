#pragma once

#include <filesystem>

#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// Writes the densities as NRRD, gzip-compressed, in the patient's frame (LPS, mm), so that `read_scan` gives
/// back every density and where it lies. Values are stored as 16-bit integers where all are whole and fit,
/// else as floats. Appears whole or not at all; throws InputError, naming the file, where it cannot be
/// written.
void write_nrrd(const std::filesystem::path& path, const DensityGrid& grid);

}  // namespace osteomill
