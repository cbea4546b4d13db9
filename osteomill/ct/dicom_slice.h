#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "osteomill/ct/slice_stack.h"

namespace osteomill {

/// How the pixels of a slice are stored, and what their numbers mean.
struct StoredPixels {
  int bits_allocated = 0;
  int bits_stored = 0;
  bool is_signed = false;
  /// Density = slope * stored value + intercept.
  double slope = 1;
  double intercept = 0;
};

/// One slice: a file, or a frame of it.
struct DicomSlice {
  std::filesystem::path file;
  /// From 0.
  std::size_t frame = 0;
  SlicePlane plane;
  StoredPixels pixels;
};

/// What one DICOM file says of itself.
struct DicomHeader {
  std::filesystem::path file;
  std::string series_uid;
  std::string series_description;
  std::string modality;
  std::string photometric;
  std::string transfer_syntax;
  int columns = 0;
  int rows = 0;
  std::size_t frames = 1;
  /// A scout view to plan a scan by, not a part of it.
  bool is_localizer = false;
  bool has_pixels = false;
  /// So damaged that even its series is not known.
  bool lost = false;
  /// Why no slice can be made of it; empty where there is nothing to complain of.
  std::string fault;
  /// A slice for each frame; empty where there is a fault.
  std::vector<DicomSlice> slices;

  /// Reports, plans, directories: not meant to be a picture.
  bool is_image() const { return has_pixels || columns > 0 || rows > 0; }
};

}  // namespace osteomill
