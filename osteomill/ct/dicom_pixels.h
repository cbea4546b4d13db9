#pragma once

#include <functional>
#include <string>

#include "osteomill/ct/dicom_slice.h"

namespace osteomill {

/// Reads the pixels of the file of `header`, which has no fault, and writes the densities of frame f, row by
/// row, to `frame_densities(f)`, which must have room for columns * rows (a null pointer: the frame is not
/// wanted). Throws InputError naming `subject` where they cannot be decompressed.
void read_dicom_densities(const std::string& subject, const DicomHeader& header,
                          const std::function<float*(std::size_t frame)>& frame_densities);

}  // namespace osteomill
