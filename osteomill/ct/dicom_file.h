#pragma once

#include <functional>
#include <optional>
#include <span>

#include "osteomill/ct/dicom_slice.h"

namespace osteomill {

/// Reads what comes before the pixels; nothing where the file is not DICOM. A file that is damaged comes with
/// a fault. Never throws for what a file holds.
std::optional<DicomHeader> read_dicom_header(const std::filesystem::path& path);

/// Decodes the pixels of the file of `header` and writes the densities of frame f, row by row, to
/// `frame_densities(f)`, which must have room for columns * rows (a null pointer: the frame is not wanted).
/// Throws InputError naming `subject` where there are fewer pixels than promised or they cannot be decoded.
void read_dicom_densities(const std::string& subject, const DicomHeader& header,
                          const std::function<float*(std::size_t frame)>& frame_densities);

}  // namespace osteomill
