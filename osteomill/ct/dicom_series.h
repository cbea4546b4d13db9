#pragma once

#include <filesystem>
#include <optional>

#include "osteomill/ct/read_scan.h"

namespace osteomill {

/// Reads the largest series of slices that lies in `folder` itself; a warning names what was left out.
/// Throws InputError naming the folder.
Scan read_dicom_folder(const std::filesystem::path& folder);

/// Reads the series to which a file belongs, from the folder in which it lies, or the frames of a file that
/// has several. Nothing where the file is not DICOM. Throws InputError naming the file.
std::optional<Scan> read_dicom_file(const std::filesystem::path& file);

}  // namespace osteomill
