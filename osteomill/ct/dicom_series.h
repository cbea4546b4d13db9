#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "osteomill/ct/dicom_file.h"

namespace osteomill {

/// Pictures that were found together, in the order of their files' names.
struct DicomImages {
  std::vector<DicomHeader> headers;
  /// Files that are no DICOM pictures.
  std::size_t other_files = 0;
};

/// Of all files of `folder`, `nested`: and of the folders in it. Throws InputError naming it where it cannot
/// be read or holds too many files. Only within `with_dicom_stack`.
DicomImages images_in_folder(const std::filesystem::path& folder, bool nested, std::uint64_t max_bytes);

/// Of the files that a DICOMDIR names, which lie beside and below it. Throws InputError naming it where it
/// names one that is not there. Only within `with_dicom_stack`.
DicomImages images_of_directory(const DicomHeader& dicomdir, std::uint64_t max_bytes);

/// One series: pictures that were taken together, in the order of their files.
struct DicomSeries {
  std::string uid;
  std::vector<DicomHeader> headers;

  bool is_ct() const;
  /// Of every slice, file by file. Throws the first fault of a file.
  std::vector<SlicePlane> planes() const;
  /// Of those slices that can be read.
  std::uint64_t pixel_count() const;
};

/// Sorts pictures by their series; where no series is named, by their folder. In the order of their first
/// files.
std::vector<DicomSeries> sort_into_series(std::vector<DicomHeader> images);

/// What a user knows a series by, in a line: number, modality, description, size, spacing, where it lies,
/// UID.
std::string describe_series(std::size_t number, const DicomSeries& series);

/// Which of `all` is `wanted`: a number from 1, a UID or the beginning of one. Empty: the one with the most
/// pixels, CT before others. Throws InputError naming `subject` where none, or more than one, is.
std::size_t pick_series(const std::string& subject, const std::vector<DicomSeries>& all,
                        const std::string& wanted);

}  // namespace osteomill
