#pragma once

#include <string>

#include "osteomill/ct/read_scan.h"

#include "dicom_file.h"

namespace osteomill {

/// Makes a scan of labels of a DICOM segmentation, whose header has no fault: each voxel has the number of
/// its segment, 0 if it has none. Only slices that hold something are stored; the others are put between
/// them. If segments overlap the one of the higher number is kept, with a warning. Throws InputError naming
/// `subject` if the frames lie on no straight, even grid. Only within `with_dicom_stack`.
Scan read_segmentation(const std::string& subject, const DicomHeader& header, const ReadOptions& options);

}  // namespace osteomill
