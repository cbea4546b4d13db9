#pragma once

#include <optional>

#include "osteomill/ct/dicom_slice.h"

namespace osteomill {

/// Reads what comes before the pixels; nothing where the file is not DICOM. A file that is damaged comes with
/// a fault. Throws InputError only where the file cannot be opened.
std::optional<DicomHeader> read_dicom_header(const std::filesystem::path& path);

}  // namespace osteomill
