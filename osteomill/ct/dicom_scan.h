#pragma once

#include <filesystem>
#include <optional>

#include "osteomill/ct/read_scan.h"

namespace osteomill {

/// Reads one of the series that lie in `folder` and the folders in it; nothing where there are no pictures.
/// Throws InputError naming the folder.
std::optional<Scan> read_dicom_folder(const std::filesystem::path& folder, const ReadOptions& options);

/// Reads the series to which a file belongs, from the folder in which it lies; the frames of a file that has
/// several; or one of the series that a DICOMDIR names. Nothing where the file is not DICOM. Throws
/// InputError naming the file.
std::optional<Scan> read_dicom_file(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace osteomill
