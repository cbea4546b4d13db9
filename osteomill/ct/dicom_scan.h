#pragma once

#include <filesystem>
#include <optional>

#include "osteomill/ct/read_scan.h"

namespace osteomill {

/// Of a folder: reads one of the series that lie in it and the folders in it; nothing where there are no
/// pictures. Of a file: the series to which it belongs, from the folder in which it lies; the frames of a
/// file that has several; or one of the series that a DICOMDIR names. Nothing where the file is not DICOM.
/// Throws InputError naming the path.
std::optional<Scan> read_dicom(const std::filesystem::path& path, const ReadOptions& options);

}  // namespace osteomill
