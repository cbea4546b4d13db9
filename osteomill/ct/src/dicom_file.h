#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/base/input_error.h"
#include "osteomill/ct/read_scan.h"

#include "series_parts.h"
#include "slice_stack.h"

class DcmDataset;
class DcmFileFormat;
class DcmPixelItem;

namespace osteomill {

/// Stored values that mark unmeasured pixels, such as those outside a round field of view.
struct Padding {
  /// All allocated bits of the padding value; many writers also set bits above the stored ones.
  std::optional<std::uint32_t> word{};
  /// Range of values, both ends inclusive.
  double least = 0;
  double most = -1;

  bool holds(double value) const { return value >= least && value <= most; }
};

/// Storage format of a slice's pixels, and the conversion to densities.
struct StoredPixels {
  int bits_allocated = 0;
  int bits_stored = 0;
  bool is_signed = false;
  /// True for floats of 32 or 64 bits.
  bool is_float = false;
  std::optional<Padding> padding{};
  /// Density = slope * stored value + intercept.
  double slope = 1;
  double intercept = 0;
};

/// Converts a stored word of an integer pixel to its value. Ignores bits above the stored ones; the highest
/// stored bit is the sign.
inline double value_of(std::uint32_t word, const StoredPixels& pixels) {
  const int unused = 32 - pixels.bits_stored;
  const std::uint32_t highest = word << unused;
  return pixels.is_signed ? static_cast<double>(static_cast<std::int32_t>(highest) >> unused)
                          : static_cast<double>(highest >> unused);
}

/// One slice: a file or a frame of a file.
struct DicomSlice {
  SlicePlane plane;
  StoredPixels pixels;
  SliceMarks marks;
  /// Segment shown in a segmentation's frame; 0 if the pixel values are segment numbers.
  int segment = 0;
};

/// Part of an Enhanced image that is split over several files.
struct Concatenation {
  std::string uid;
  int number = 0;
  /// Number of parts; 0 if not stated.
  int total = 0;
};

/// Header of one DICOM file.
struct DicomHeader {
  std::filesystem::path file;
  std::string series_uid;
  std::string series_description;
  std::string modality;
  /// True for CT whose RescaleType is missing or HU.
  bool in_hounsfield_units = false;
  std::string photometric;
  int columns = 0;
  int rows = 0;
  std::size_t frames = 1;
  /// True for a scout view (localizer), which is not part of a scan.
  bool is_localizer = false;
  bool is_compressed = false;
  /// UID of the actual transfer syntax of the pixels.
  std::string syntax;
  /// Transfer syntax if no decoder supports it; otherwise empty.
  std::string undecodable;
  /// Stored size of its pixels, bytes; 0 if it has none.
  std::uint64_t pixel_bytes = 0;
  /// For a DICOMDIR: the images it lists, relative to its folder.
  std::vector<std::filesystem::path> listed_files;
  /// True if the file is so damaged that not even its series is known.
  bool lost = false;
  /// Reason why it cannot be read as slices.
  std::optional<InputError> fault;
  /// Phrase describing a picture that is not a slice of a scan: in colour, or without a position. Empty
  /// otherwise.
  std::string no_slice;
  std::optional<Concatenation> concatenation;
  /// Warning on how it was read; empty if there is none.
  std::string warning;
  /// True if its frames show segments, not densities.
  bool is_segmentation = false;
  std::vector<LabelName> segments;
  /// Minimum pixel value that belongs to the segment.
  float least_segment_value = 1;
  /// Slice distance of a segmentation, or else slice thickness, mm; 0 if not stated.
  double slice_distance_mm = 0;
  /// One slice per frame; empty if there is a fault.
  std::vector<DicomSlice> slices;

  /// Data as read, pixels still in the file. Release only within `with_dicom_stack`.
  std::shared_ptr<DcmFileFormat> data;

  /// Returns whether it is a DICOMDIR, which lists the files of a disc.
  bool is_directory() const { return !listed_files.empty(); }
  /// Returns whether it is a picture, not a report, plan or directory.
  bool is_image() const { return pixel_bytes > 0 || columns > 0 || rows > 0; }
};

/// Reads everything before the pixels; returns nullopt if the file is not DICOM. Reports an unreadable or
/// damaged file in `fault`. Call only within `with_dicom_stack`.
std::optional<DicomHeader> read_dicom_header(const std::filesystem::path& path, std::uint64_t max_bytes);

/// Returns the items of compressed pixels: the offset table, then the fragments in order. Empty if the pixels
/// are not compressed.
std::vector<DcmPixelItem*> pixel_items_of(DcmDataset& data);

/// Decodes the pixels of the file of `header`, which must have no fault. Writes the densities of frame f, row
/// by row, to `frame_densities(f)`, which must have room for columns * rows; skips the frame if that is null.
/// Padding becomes NaN. Returns true if the compressed data are signed, with negative values, but the header
/// says unsigned; the compressed data are then taken as correct. Throws InputError, naming the file, if it
/// cannot be decoded. Call only within `with_dicom_stack`.
bool read_dicom_densities(const DicomHeader& header,
                          const std::function<float*(std::size_t frame)>& frame_densities);

/// Reads DICOM. From a folder, reads one of the series in it and its subfolders; returns nullopt if there are
/// no pictures. From a file, reads its series from the same folder, the frames of a multi-frame file, or one
/// of the series that a DICOMDIR lists; returns nullopt if the file is not DICOM. Throws InputError, naming
/// the path.
std::optional<Scan> read_dicom(const std::filesystem::path& path, const ReadOptions& options);

}  // namespace osteomill
