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

/// Stored values that only fill the picture, as outside of a round field of view, which was not measured.
struct Padding {
  /// All bits of the integer that fills; many writers use bits beyond the stored ones for it.
  std::optional<std::uint32_t> word{};
  /// A range of values, both ends of it included.
  double least = 0;
  double most = -1;

  bool holds(double value) const { return value >= least && value <= most; }
};

/// The form in which the pixels of a slice are stored, and the meaning of their numbers.
struct StoredPixels {
  int bits_allocated = 0;
  int bits_stored = 0;
  bool is_signed = false;
  /// Floats of 32 or 64 bits.
  bool is_float = false;
  std::optional<Padding> padding{};
  /// Density = slope * stored value + intercept.
  double slope = 1;
  double intercept = 0;
};

/// Returns the number that a stored word of integer pixels stands for. Bits above the stored ones may hold
/// anything; the sign is in the highest stored one.
inline double value_of(std::uint32_t word, const StoredPixels& pixels) {
  const int unused = 32 - pixels.bits_stored;
  const std::uint32_t highest = word << unused;
  return pixels.is_signed ? static_cast<double>(static_cast<std::int32_t>(highest) >> unused)
                          : static_cast<double>(highest >> unused);
}

/// One slice: a file, or a frame of it.
struct DicomSlice {
  SlicePlane plane;
  StoredPixels pixels;
  SliceMarks marks;
  /// The segment that a segmentation's frame shows; 0 if its values are the segments' numbers.
  int segment = 0;
};

/// The file's place among those over which one Enhanced image was parted.
struct Concatenation {
  std::string uid;
  int number = 0;
  /// How many there are; 0 if it does not say.
  int total = 0;
};

/// The header of one DICOM file.
struct DicomHeader {
  std::filesystem::path file;
  std::string series_uid;
  std::string series_description;
  std::string modality;
  /// CT, rescaled to what is not said to be another unit.
  bool in_hounsfield_units = false;
  std::string photometric;
  int columns = 0;
  int rows = 0;
  std::size_t frames = 1;
  /// A scout view to plan a scan by, not a part of it.
  bool is_localizer = false;
  bool is_compressed = false;
  /// The UID of the transfer syntax in which its pixels are.
  std::string syntax;
  /// The transfer syntax if it is one that nothing here decodes; else empty.
  std::string undecodable;
  /// The size of its pixels as they are stored; 0 if it has none.
  std::uint64_t pixel_bytes = 0;
  /// For a DICOMDIR, the images that it names, relative to its folder.
  std::vector<std::filesystem::path> listed_files;
  /// So damaged that even its series is not known.
  bool lost = false;
  /// Why no slice can be made of it.
  std::optional<InputError> fault;
  /// A picture that is no slice of a scan, in half a sentence: in colour, or without any place.
  std::string no_slice;
  std::optional<Concatenation> concatenation;
  /// A warning on how it was read; empty if there is none.
  std::string warning;
  /// Its frames show segments, not densities.
  bool is_segmentation = false;
  std::vector<LabelName> segments;
  /// Values from here on belong to the segment.
  float least_segment_value = 1;
  /// How far apart its slices are, or how thick; 0 if it does not say.
  double slice_distance_mm = 0;
  /// A slice for each frame; empty if there is a fault.
  std::vector<DicomSlice> slices;

  /// The data as read, pixels still in the file; `with_dicom_stack` releases them.
  std::shared_ptr<DcmFileFormat> data;

  /// It lists the files of a disc.
  bool is_directory() const { return !listed_files.empty(); }
  /// Reports, plans, directories: not meant to be a picture.
  bool is_image() const { return pixel_bytes > 0 || columns > 0 || rows > 0; }
};

/// Reads what comes before the pixels; nothing if the file is not DICOM. A file that cannot be read or is
/// damaged comes with a fault. Only within `with_dicom_stack`.
std::optional<DicomHeader> read_dicom_header(const std::filesystem::path& path, std::uint64_t max_bytes);

/// The items of compressed pixels: the table of offsets, and the fragments in order. None if they are not
/// compressed.
std::vector<DcmPixelItem*> pixel_items_of(DcmDataset& data);

/// Decodes the pixels of the file of `header`, which has no fault, and writes the densities of frame f, row
/// by row, to `frame_densities(f)`, which must have room for columns * rows (a null pointer: the frame is not
/// wanted). Padding becomes NaN. Returns whether compressed values are signed, some below zero, though the
/// header says that they are not: they are taken as they say themselves. Throws InputError naming the file
/// if they cannot be decoded. Only within `with_dicom_stack`.
bool read_dicom_densities(const DicomHeader& header,
                          const std::function<float*(std::size_t frame)>& frame_densities);

/// Reads DICOM. From a folder it reads one of the series that lie in it and the folders in it; returns
/// nothing if there are no pictures. From a file it reads the series to which the file belongs, from the
/// folder in which it lies; the frames of a file that has several; or one of the series that a DICOMDIR
/// names. Returns nothing if the file is not DICOM. Throws InputError naming the path.
std::optional<Scan> read_dicom(const std::filesystem::path& path, const ReadOptions& options);

}  // namespace osteomill
