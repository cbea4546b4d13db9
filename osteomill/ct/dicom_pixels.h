#pragma once

#include <functional>

#include "osteomill/ct/dicom_file.h"

namespace osteomill {

/// Decodes the pixels of the file of `header`, which has no fault, and writes the densities of frame f, row
/// by row, to `frame_densities(f)`, which must have room for columns * rows (a null pointer: the frame is not
/// wanted). Throws InputError naming the file where they cannot be decoded. Only within `with_dicom_stack`.
void read_dicom_densities(const DicomHeader& header,
                          const std::function<float*(std::size_t frame)>& frame_densities);

}  // namespace osteomill
