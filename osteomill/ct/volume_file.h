#pragma once

#include <filesystem>
#include <optional>

#include "osteomill/ct/read_scan.h"
#include "osteomill/ct/volume_header.h"

namespace osteomill {

enum class VolumeFormat { nrrd, metaimage, nifti };

/// By how the file's name ends.
std::optional<VolumeFormat> volume_format_of(const std::filesystem::path& path);

/// The header alone. Throws InputError naming the file.
VolumeHeader read_volume_header(const std::filesystem::path& path, VolumeFormat format);

/// Reads a volume that lies in one file (or in a header and a file of voxels).
/// Throws InputError naming the file.
Scan read_volume_file(const std::filesystem::path& path, VolumeFormat format, const ReadOptions& options);

}  // namespace osteomill
