#pragma once

#include <string>

#include "osteomill/ct/read_scan.h"

#include "dicom_file.h"

namespace osteomill {

/// Converts a DICOM segmentation, whose header must have no fault, to a scan of labels: each voxel has the
/// number of its segment, or 0. Adds the empty slices, which segmentations may omit. If segments overlap,
/// keeps the higher number and adds a warning. Throws InputError, naming `subject`, if the frames do not lie
/// on a straight, even grid. Call only within `with_dicom_stack`.
Scan read_segmentation(const std::string& subject, const DicomHeader& header, const ReadOptions& options);

}  // namespace osteomill
