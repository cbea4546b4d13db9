#include "osteomill/ct/dicom_file.h"

#include <cmath>

#include <fmt/format.h>

#include "osteomill/ct/dicom_elements.h"
#include "osteomill/ct/parse_numbers.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

using namespace dicom_tag;

// Compressed pixels may claim this much, and this many times their own length; a blank slice comes down a
// lot.
constexpr std::uint64_t kAlwaysAllowed_bytes = 1 << 26;
constexpr std::uint64_t kMostCompression = 2000;

struct Fault {
  std::string reason;
};

std::string text_of(const DicomItem& data, std::uint32_t tag) {
  const auto element = data.elements.find(tag);
  if (element == data.elements.end()) return {};
  const std::string text = element->second.value.substr(0, element->second.value.find('\0'));
  const std::size_t start = text.find_first_not_of(' ');
  if (start == std::string::npos) return {};
  return text.substr(start, text.find_last_not_of(' ') - start + 1);
}

// An unsigned short.
std::optional<int> short_of(const DicomFile& file, std::uint32_t tag) {
  const auto element = file.data.elements.find(tag);
  if (element == file.data.elements.end() || element->second.value.size() < 2) return std::nullopt;
  const auto first = static_cast<unsigned char>(element->second.value[0]);
  const auto second = static_cast<unsigned char>(element->second.value[1]);
  return file.big_endian ? first << 8 | second : second << 8 | first;
}

std::optional<std::vector<double>> numbers_of(const DicomItem& data, std::uint32_t tag, std::size_t count,
                                              const char* name) {
  const std::string text = text_of(data, tag);
  if (text.empty()) return std::nullopt;
  std::optional<std::vector<double>> numbers = parse_numbers(text, " \\");
  if (!numbers || numbers->size() != count) {
    throw Fault{fmt::format("has a {} that is not {} number{}", name, count, count == 1 ? "" : "s")};
  }
  for (const double number : *numbers) {
    if (!std::isfinite(number)) throw Fault{fmt::format("has a {} that is not finite", name)};
  }
  return numbers;
}

const std::vector<DicomItem>* items_of(const DicomItem& data, std::uint32_t tag) {
  const auto element = data.elements.find(tag);
  return element == data.elements.end() ? nullptr : &element->second.items;
}

// Where a frame's values are looked for: its own functional group, the group that all frames share, the data
// set.
class FrameValues {
 public:
  FrameValues(const DicomItem& data, std::size_t frame)
      : data_(data),
        shared_(items_of(data, kSharedGroups)),
        own_(items_of(data, kFrameGroups)),
        frame_(frame) {}

  std::optional<std::vector<double>> find(std::uint32_t group, std::uint32_t tag, std::size_t count,
                                          const char* name) const {
    std::optional<std::vector<double>> numbers = find_in(own_, frame_, group, tag, count, name);
    if (!numbers) numbers = find_in(shared_, 0, group, tag, count, name);
    if (!numbers) numbers = numbers_of(data_, tag, count, name);
    return numbers;
  }

 private:
  static std::optional<std::vector<double>> find_in(const std::vector<DicomItem>* items, std::size_t number,
                                                    std::uint32_t group, std::uint32_t tag, std::size_t count,
                                                    const char* name) {
    if (items == nullptr || number >= items->size()) return std::nullopt;
    const std::vector<DicomItem>* inner = items_of((*items)[number], group);
    if (inner == nullptr || inner->empty()) return std::nullopt;
    return numbers_of(inner->front(), tag, count, name);
  }

  const DicomItem& data_;
  const std::vector<DicomItem>* shared_;
  const std::vector<DicomItem>* own_;
  std::size_t frame_;
};

StoredPixels stored_pixels(const DicomFile& file) {
  StoredPixels pixels;
  pixels.bits_allocated = short_of(file, kBitsAllocated).value_or(0);
  pixels.bits_stored = short_of(file, kBitsStored).value_or(pixels.bits_allocated);
  pixels.is_signed = short_of(file, kPixelRepresentation).value_or(0) == 1;
  const int high_bit = short_of(file, kHighBit).value_or(pixels.bits_stored - 1);
  const bool whole_bytes =
      pixels.bits_allocated == 8 || pixels.bits_allocated == 16 || pixels.bits_allocated == 32;
  if (!whole_bytes || pixels.bits_stored < 1 || pixels.bits_stored > pixels.bits_allocated ||
      high_bit != pixels.bits_stored - 1) {
    throw Fault{fmt::format("has pixels of {} bits in {}, the highest being bit {}, which is not supported",
                            pixels.bits_stored, pixels.bits_allocated, high_bit)};
  }
  return pixels;
}

SlicePlane plane_of(const DicomHeader& header, const FrameValues& values) {
  const auto spacing = values.find(kPixelMeasuresGroup, kPixelSpacing, 2, "PixelSpacing");
  if (!spacing) throw Fault{"has no PixelSpacing, so its size is not known"};
  const auto position = values.find(kPlanePositionGroup, kPosition, 3, "ImagePositionPatient");
  if (!position) throw Fault{"has no ImagePositionPatient, so its place is not known"};
  const auto orientation = values.find(kPlaneOrientationGroup, kOrientation, 6, "ImageOrientationPatient");
  if (!orientation) throw Fault{"has no ImageOrientationPatient, so its place is not known"};

  SlicePlane plane;
  plane.columns = header.columns;
  plane.rows = header.rows;
  // PixelSpacing: first from row to row, then from column to column (Part 3, 10.7.1.3).
  plane.row_distance_mm = (*spacing)[0];
  plane.column_distance_mm = (*spacing)[1];
  plane.i_direction = Vec3((*orientation)[0], (*orientation)[1], (*orientation)[2]);
  plane.j_direction = Vec3((*orientation)[3], (*orientation)[4], (*orientation)[5]);
  plane.position_mm = Vec3((*position)[0], (*position)[1], (*position)[2]);
  return plane;
}

DicomSlice slice_of(const DicomHeader& header, const DicomFile& file, std::size_t frame) {
  const FrameValues values(file.data, frame);
  DicomSlice slice;
  slice.file = header.file;
  slice.frame = frame;
  slice.plane = plane_of(header, values);
  const std::string instance_uid = text_of(file.data, kInstanceUid);
  const std::string file_name = header.file.filename().string();
  slice.plane.name = header.frames == 1 ? file_name : fmt::format("{} frame {}", file_name, frame + 1);
  slice.plane.instance = instance_uid.empty() ? "" : fmt::format("{}#{}", instance_uid, frame);
  slice.pixels = stored_pixels(file);
  const auto slope = values.find(kPixelTransformationGroup, kRescaleSlope, 1, "RescaleSlope");
  const auto intercept = values.find(kPixelTransformationGroup, kRescaleIntercept, 1, "RescaleIntercept");
  if (slope) slice.pixels.slope = slope->front();
  if (intercept) slice.pixels.intercept = intercept->front();
  if (slice.pixels.slope == 0) throw Fault{"has a RescaleSlope of 0, which leaves nothing of its values"};
  return slice;
}

void check_byte_count(const DicomHeader& header, const DicomFile& file, const StoredPixels& pixels) {
  const std::uint64_t needed = static_cast<std::uint64_t>(header.columns) *
                               static_cast<std::uint64_t>(header.rows) * header.frames *
                               static_cast<std::uint64_t>(pixels.bits_allocated / 8);
  const std::uint64_t stored = file.pixels.bytes();
  const std::uint64_t possible =
      file.pixels.compressed ? stored * kMostCompression + kAlwaysAllowed_bytes : stored;
  if (needed > possible) {
    throw Fault{fmt::format("is cut short: {} x {} pixels{} need {} bytes, it holds {}", header.columns,
                            header.rows, header.frames > 1 ? fmt::format(" x {} frames", header.frames) : "",
                            needed, stored)};
  }
}

void read_slices(DicomHeader& header, const DicomFile& file) {
  if (!header.has_pixels) throw Fault{"has no pixels"};
  if (header.columns < 1 || header.rows < 1) {
    throw Fault{fmt::format("has no size: {} columns x {} rows", header.columns, header.rows)};
  }
  if (short_of(file, kSamplesPerPixel).value_or(1) != 1 || header.photometric.find("MONOCHROME") != 0) {
    throw Fault{fmt::format("is a colour image ({}), not a scan", header.photometric)};
  }
  if (file.data.elements.contains(kModalityTable))
    throw Fault{"needs a modality lookup table, which is not supported"};
  const bool grouped = file.data.elements.contains(kFrameGroups);
  if (header.frames > 1 && !grouped)
    throw Fault{"has several frames and does not say where each of them lies"};
  check_byte_count(header, file, stored_pixels(file));
  for (std::size_t frame = 0; frame < header.frames; ++frame) {
    header.slices.push_back(slice_of(header, file, frame));
  }
}

void read_header(DicomHeader& header, const DicomFile& file) {
  header.transfer_syntax = file.transfer_syntax;
  header.has_pixels = file.pixels.bytes() > 0;
  header.series_uid = text_of(file.data, kSeriesUid);
  header.series_description = text_of(file.data, kSeriesDescription);
  header.modality = text_of(file.data, kModality);
  header.photometric = text_of(file.data, kPhotometric);
  header.columns = short_of(file, kColumns).value_or(0);
  header.rows = short_of(file, kRows).value_or(0);
  header.is_localizer = text_of(file.data, kImageType).find("LOCALIZER") != std::string::npos;
  // Damaged before the pixels: even the series may be unknown.
  header.lost = file.fault && !header.has_pixels;
  if (file.fault) throw Fault{*file.fault};
  if (const auto frames = numbers_of(file.data, kFrames, 1, "NumberOfFrames")) {
    if (frames->front() < 1 || frames->front() > 1 << 16) throw Fault{"has no sensible NumberOfFrames"};
    header.frames = static_cast<std::size_t>(frames->front());
  }
  read_slices(header, file);
}

}  // namespace

std::optional<DicomHeader> read_dicom_header(const fs::path& path) {
  const std::optional<DicomFile> file = read_dicom_elements(path);
  if (!file) return std::nullopt;
  DicomHeader header;
  header.file = path;
  try {
    read_header(header, *file);
  } catch (const Fault& fault) {
    header.fault = fault.reason;
    header.slices.clear();
  }
  return header;
}

}  // namespace osteomill
