#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace osteomill {

/// What can be told of a file without believing what it says of itself.
struct DicomLengths {
  /// False where it is not DICOM at all; then nothing else is filled.
  bool is_dicom = false;
  /// TransferSyntaxUID; empty where the file has no meta group.
  std::string transfer_syntax;
  /// There is a PixelData element that is not empty.
  bool has_pixels = false;
  /// Why the file must not be handed to a DICOM library: an element that is longer than what is left of the
  /// file (the file was cut short or damaged). The library would allocate that length, or read on with what
  /// it has.
  std::optional<std::string> fault;
  /// Everything before the pixels is sound all the same.
  bool sound_before_pixels = false;
};

/// Walks over all elements of a DICOM file, nested ones too, and checks each length against what is left.
/// Deflated data sets are inflated for it. Throws InputError only where the file cannot be opened.
DicomLengths check_dicom_lengths(const std::filesystem::path& path);

}  // namespace osteomill
