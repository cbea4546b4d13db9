#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "osteomill/ct/dicom_slice.h"

class DcmDataset;
class DcmPixelItem;

namespace osteomill {

/// Reads what comes before the pixels; nothing where the file is not DICOM. A file that cannot be read or is
/// damaged comes with a fault. Only within `with_dicom_stack`.
std::optional<DicomHeader> read_dicom_header(const std::filesystem::path& path);

/// The items of compressed pixels: the table of offsets, and the fragments in order. None where they are not
/// compressed.
std::vector<DcmPixelItem*> pixel_items_of(DcmDataset& data);

}  // namespace osteomill
