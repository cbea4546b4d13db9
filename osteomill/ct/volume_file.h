#pragma once

#include <filesystem>

#include "osteomill/ct/read_scan.h"

namespace osteomill {

enum class VolumeFormat { nrrd, metaimage, nifti };

/// Reads a volume that lies in one file (or in a header and a file of voxels).
/// Throws InputError naming the file.
Scan read_volume_file(const std::filesystem::path& path, VolumeFormat format, const ReadOptions& options);

}  // namespace osteomill
