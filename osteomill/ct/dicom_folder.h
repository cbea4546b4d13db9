#pragma once

#include <filesystem>
#include <vector>

#include "osteomill/ct/dicom_slice.h"

namespace osteomill {

/// Pictures that were found together, in the order of their files' names.
struct DicomImages {
  std::vector<DicomHeader> headers;
  /// Files that are no DICOM pictures.
  std::size_t other_files = 0;
};

/// Of all files of `folder`, `nested`: and of the folders in it. Throws InputError naming it where it cannot
/// be read or holds too many files. Only within `with_dicom_stack`.
DicomImages images_in_folder(const std::filesystem::path& folder, bool nested);

/// Of the files that a DICOMDIR names, which lie beside and below it. Throws InputError naming it where it
/// names one that is not there. Only within `with_dicom_stack`.
DicomImages images_of_directory(const DicomHeader& dicomdir);

}  // namespace osteomill
