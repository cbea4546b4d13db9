#include "osteomill/ct/dicom_file.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>
#include <gdcmImageReader.h>
#include <gdcmSequenceOfItems.h>
#include <gdcmTrace.h>
#include <gdcmUIDs.h>

#include "osteomill/ct/dicom_lengths.h"
#include "osteomill/ct/parse_numbers.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

const gdcm::Tag kImageType(0x0008, 0x0008);
const gdcm::Tag kInstanceUid(0x0008, 0x0018);
const gdcm::Tag kModality(0x0008, 0x0060);
const gdcm::Tag kSeriesDescription(0x0008, 0x103e);
const gdcm::Tag kSeriesUid(0x0020, 0x000e);
const gdcm::Tag kPosition(0x0020, 0x0032);
const gdcm::Tag kOrientation(0x0020, 0x0037);
const gdcm::Tag kSamplesPerPixel(0x0028, 0x0002);
const gdcm::Tag kPhotometric(0x0028, 0x0004);
const gdcm::Tag kFrames(0x0028, 0x0008);
const gdcm::Tag kRows(0x0028, 0x0010);
const gdcm::Tag kColumns(0x0028, 0x0011);
const gdcm::Tag kPixelSpacing(0x0028, 0x0030);
const gdcm::Tag kBitsAllocated(0x0028, 0x0100);
const gdcm::Tag kBitsStored(0x0028, 0x0101);
const gdcm::Tag kHighBit(0x0028, 0x0102);
const gdcm::Tag kPixelRepresentation(0x0028, 0x0103);
const gdcm::Tag kRescaleIntercept(0x0028, 0x1052);
const gdcm::Tag kRescaleSlope(0x0028, 0x1053);
const gdcm::Tag kModalityTable(0x0028, 0x3000);
const gdcm::Tag kSharedGroups(0x5200, 0x9229);
const gdcm::Tag kFrameGroups(0x5200, 0x9230);
const gdcm::Tag kPlanePosition(0x0020, 0x9113);
const gdcm::Tag kPlaneOrientation(0x0020, 0x9116);
const gdcm::Tag kPixelMeasures(0x0028, 0x9110);
const gdcm::Tag kPixelTransformation(0x0028, 0x9145);
const gdcm::Tag kPixelData(0x7fe0, 0x0010);

// Compressed pixels may claim this much, and this many times their own length; a blank slice comes down a
// lot.
constexpr std::uint64_t kAlwaysAllowed_bytes = 1 << 26;
constexpr std::uint64_t kMostCompression = 2000;

struct Fault {
  std::string reason;
};

void silence_gdcm() {
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  gdcm::Trace::DebugOff();
}

std::string text_of(const gdcm::DataSet& data, const gdcm::Tag& tag) {
  if (!data.FindDataElement(tag)) return {};
  const gdcm::ByteValue* bytes = data.GetDataElement(tag).GetByteValue();
  if (bytes == nullptr) return {};
  std::string text(bytes->GetPointer(), bytes->GetLength());
  text.erase(std::min(text.find('\0'), text.size()));
  const std::size_t start = text.find_first_not_of(' ');
  if (start == std::string::npos) return {};
  return text.substr(start, text.find_last_not_of(' ') - start + 1);
}

// An unsigned short; the library has turned its bytes to the machine's order.
std::optional<int> short_of(const gdcm::DataSet& data, const gdcm::Tag& tag) {
  if (!data.FindDataElement(tag)) return std::nullopt;
  const gdcm::ByteValue* bytes = data.GetDataElement(tag).GetByteValue();
  if (bytes == nullptr || bytes->GetLength() < 2) return std::nullopt;
  std::uint16_t number = 0;
  std::memcpy(&number, bytes->GetPointer(), sizeof(number));
  return number;
}

std::optional<std::vector<double>> numbers_of(const gdcm::DataSet& data, const gdcm::Tag& tag,
                                              std::size_t count, const char* name) {
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

// Where a frame's values are looked for: its own functional group, the group that all frames share, the data
// set.
class FrameValues {
 public:
  FrameValues(const gdcm::DataSet& data, std::size_t frame) : data_(data) {
    shared_ = items_of(data, kSharedGroups);
    own_ = items_of(data, kFrameGroups);
    own_number_ = frame + 1;
  }

  std::optional<std::vector<double>> find(const gdcm::Tag& group, const gdcm::Tag& tag, std::size_t count,
                                          const char* name) const {
    std::optional<std::vector<double>> numbers = find_in(own_, own_number_, group, tag, count, name);
    if (!numbers) numbers = find_in(shared_, 1, group, tag, count, name);
    if (!numbers) numbers = numbers_of(data_, tag, count, name);
    return numbers;
  }

 private:
  static gdcm::SmartPointer<gdcm::SequenceOfItems> items_of(const gdcm::DataSet& data, const gdcm::Tag& tag) {
    if (!data.FindDataElement(tag)) return nullptr;
    return data.GetDataElement(tag).GetValueAsSQ();
  }

  static std::optional<std::vector<double>> find_in(const gdcm::SmartPointer<gdcm::SequenceOfItems>& items,
                                                    std::size_t number, const gdcm::Tag& group,
                                                    const gdcm::Tag& tag, std::size_t count,
                                                    const char* name) {
    if (items == nullptr || number > items->GetNumberOfItems()) return std::nullopt;
    const auto inner = items_of(items->GetItem(number).GetNestedDataSet(), group);
    if (inner == nullptr || inner->GetNumberOfItems() < 1) return std::nullopt;
    return numbers_of(inner->GetItem(1).GetNestedDataSet(), tag, count, name);
  }

  const gdcm::DataSet& data_;
  gdcm::SmartPointer<gdcm::SequenceOfItems> shared_;
  gdcm::SmartPointer<gdcm::SequenceOfItems> own_;
  std::size_t own_number_;
};

StoredPixels stored_pixels(const gdcm::DataSet& data) {
  StoredPixels pixels;
  pixels.bits_allocated = short_of(data, kBitsAllocated).value_or(0);
  pixels.bits_stored = short_of(data, kBitsStored).value_or(pixels.bits_allocated);
  pixels.is_signed = short_of(data, kPixelRepresentation).value_or(0) == 1;
  const int high_bit = short_of(data, kHighBit).value_or(pixels.bits_stored - 1);
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
  const auto spacing = values.find(kPixelMeasures, kPixelSpacing, 2, "PixelSpacing");
  if (!spacing) throw Fault{"has no PixelSpacing, so its size is not known"};
  const auto position = values.find(kPlanePosition, kPosition, 3, "ImagePositionPatient");
  if (!position) throw Fault{"has no ImagePositionPatient, so its place is not known"};
  const auto orientation = values.find(kPlaneOrientation, kOrientation, 6, "ImageOrientationPatient");
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

DicomSlice slice_of(const DicomHeader& header, const gdcm::DataSet& data, std::size_t frame) {
  const FrameValues values(data, frame);
  DicomSlice slice;
  slice.file = header.file;
  slice.frame = frame;
  slice.plane = plane_of(header, values);
  const std::string instance_uid = text_of(data, kInstanceUid);
  const std::string file_name = header.file.filename().string();
  slice.plane.name = header.frames == 1 ? file_name : fmt::format("{} frame {}", file_name, frame + 1);
  slice.plane.instance = instance_uid.empty() ? "" : fmt::format("{}#{}", instance_uid, frame);
  slice.pixels = stored_pixels(data);
  const auto slope = values.find(kPixelTransformation, kRescaleSlope, 1, "RescaleSlope");
  const auto intercept = values.find(kPixelTransformation, kRescaleIntercept, 1, "RescaleIntercept");
  if (slope) slice.pixels.slope = slope->front();
  if (intercept) slice.pixels.intercept = intercept->front();
  if (slice.pixels.slope == 0) throw Fault{"has a RescaleSlope of 0, which leaves nothing of its values"};
  return slice;
}

void read_slices(DicomHeader& header, const gdcm::DataSet& data) {
  if (!header.has_pixels) throw Fault{"has no pixels"};
  if (header.columns < 1 || header.rows < 1) {
    throw Fault{fmt::format("has no size: {} columns x {} rows", header.columns, header.rows)};
  }
  if (short_of(data, kSamplesPerPixel).value_or(1) != 1 || header.photometric.find("MONOCHROME") != 0) {
    throw Fault{fmt::format("is a colour image ({}), not a scan", header.photometric)};
  }
  if (data.FindDataElement(kModalityTable))
    throw Fault{"needs a modality lookup table, which is not supported"};
  const bool grouped = data.FindDataElement(kFrameGroups);
  if (header.frames > 1 && !grouped)
    throw Fault{"has several frames and does not say where each of them lies"};
  if (header.frames > 1 << 16) throw Fault{fmt::format("says that it has {} frames", header.frames)};
  for (std::size_t frame = 0; frame < header.frames; ++frame) {
    header.slices.push_back(slice_of(header, data, frame));
  }
}

void read_header(DicomHeader& header) {
  gdcm::Reader reader;
  reader.SetFileName(header.file.c_str());
  if (!reader.ReadUpToTag(kPixelData, {kPixelData})) throw Fault{"cannot be understood as DICOM"};
  const gdcm::DataSet& data = reader.GetFile().GetDataSet();
  header.series_uid = text_of(data, kSeriesUid);
  header.series_description = text_of(data, kSeriesDescription);
  header.modality = text_of(data, kModality);
  header.photometric = text_of(data, kPhotometric);
  header.columns = short_of(data, kColumns).value_or(0);
  header.rows = short_of(data, kRows).value_or(0);
  header.is_localizer = text_of(data, kImageType).find("LOCALIZER") != std::string::npos;
  header.readable = true;
  if (const auto frames = numbers_of(data, kFrames, 1, "NumberOfFrames")) {
    if (frames->front() < 1 || frames->front() > 1e6) throw Fault{"has no sensible NumberOfFrames"};
    header.frames = static_cast<std::size_t>(frames->front());
  }
  read_slices(header, data);
}

std::string codec_name(const DicomHeader& header) {
  const auto syntax = gdcm::TransferSyntax::GetTSType(header.transfer_syntax.c_str());
  if (syntax == gdcm::TransferSyntax::TS_END) return "transfer syntax " + header.transfer_syntax;
  gdcm::UIDs names;
  names.SetFromUID(header.transfer_syntax.c_str());
  return names.GetName();
}

std::uint64_t stored_bytes(const gdcm::DataElement& pixels, bool& compressed) {
  if (const gdcm::ByteValue* bytes = pixels.GetByteValue()) {
    compressed = false;
    return bytes->GetLength();
  }
  compressed = true;
  const gdcm::SequenceOfFragments* fragments = pixels.GetSequenceOfFragments();
  return fragments == nullptr ? 0 : fragments->ComputeByteLength();
}

void check_byte_count(const DicomHeader& header, const gdcm::DataSet& data, std::uint64_t needed) {
  bool compressed = false;
  const std::uint64_t stored = stored_bytes(data.GetDataElement(kPixelData), compressed);
  if (compressed ? needed > stored * kMostCompression + kAlwaysAllowed_bytes : needed > stored) {
    throw Fault{fmt::format("is cut short: {} x {} pixels{} need {} bytes, it holds {}", header.columns,
                            header.rows, header.frames > 1 ? fmt::format(" x {} frames", header.frames) : "",
                            needed, stored)};
  }
}

template <typename Stored>
void rescale(const std::vector<char>& buffer, std::size_t first, const StoredPixels& pixels,
             std::size_t count, float* densities) {
  // Bits above the stored ones may hold anything; the sign is in the highest stored one.
  using Wide = std::make_unsigned_t<Stored>;
  const int unused = static_cast<int>(8 * sizeof(Stored)) - pixels.bits_stored;
  const char* bytes = buffer.data() + first * sizeof(Stored);
  for (std::size_t n = 0; n < count; ++n, bytes += sizeof(Stored)) {
    Wide raw = 0;
    std::memcpy(&raw, bytes, sizeof(raw));
    raw = static_cast<Wide>(raw << unused);
    const auto value = static_cast<Stored>(static_cast<Stored>(raw) >> unused);
    densities[n] = static_cast<float>(pixels.slope * static_cast<double>(value) + pixels.intercept);
  }
}

void rescale_frame(const std::vector<char>& buffer, std::size_t first, const StoredPixels& pixels,
                   std::size_t count, float* densities) {
  const int kind = pixels.is_signed ? -pixels.bits_allocated : pixels.bits_allocated;
  switch (kind) {
    case 8:
      return rescale<std::uint8_t>(buffer, first, pixels, count, densities);
    case -8:
      return rescale<std::int8_t>(buffer, first, pixels, count, densities);
    case 16:
      return rescale<std::uint16_t>(buffer, first, pixels, count, densities);
    case -16:
      return rescale<std::int16_t>(buffer, first, pixels, count, densities);
    case 32:
      return rescale<std::uint32_t>(buffer, first, pixels, count, densities);
    default:
      return rescale<std::int32_t>(buffer, first, pixels, count, densities);
  }
}

std::vector<char> decode(const DicomHeader& header) {
  const std::size_t count =
      static_cast<std::size_t>(header.columns) * static_cast<std::size_t>(header.rows) * header.frames;
  const int bits = header.slices.front().pixels.bits_allocated;
  const std::uint64_t needed = static_cast<std::uint64_t>(count) * static_cast<std::uint64_t>(bits / 8);
  gdcm::ImageReader reader;
  reader.SetFileName(header.file.c_str());
  if (!reader.Read()) throw Fault{fmt::format("cannot be decoded ({})", codec_name(header))};
  check_byte_count(header, reader.GetFile().GetDataSet(), needed);
  const gdcm::Image& image = reader.GetImage();
  const unsigned int* dims = image.GetDimensions();
  const std::uint64_t frames = image.GetNumberOfDimensions() > 2 ? dims[2] : 1;
  if (static_cast<int>(dims[0]) != header.columns || static_cast<int>(dims[1]) != header.rows ||
      frames != header.frames || image.GetPixelFormat().GetBitsAllocated() != bits ||
      image.GetBufferLength() != needed) {
    throw Fault{
        fmt::format("holds pixels of another size or type than its header says ({})", codec_name(header))};
  }
  std::vector<char> buffer(needed);
  if (!image.GetBuffer(buffer.data())) {
    throw Fault{
        fmt::format("cannot be decoded ({}): its pixels are cut short or damaged", codec_name(header))};
  }
  return buffer;
}

}  // namespace

std::optional<DicomHeader> read_dicom_header(const fs::path& path) {
  silence_gdcm();
  const DicomLengths lengths = check_dicom_lengths(path);
  if (!lengths.is_dicom) return std::nullopt;
  DicomHeader header;
  header.file = path;
  header.transfer_syntax = lengths.transfer_syntax;
  header.has_pixels = lengths.has_pixels;
  try {
    // Even of a file that is cut short it is good to know to which series it belongs.
    if (lengths.sound_before_pixels) read_header(header);
    if (lengths.fault) throw Fault{*lengths.fault};
  } catch (const Fault& fault) {
    header.fault = fault.reason;
  } catch (const std::exception&) {
    header.fault = "cannot be understood as DICOM";
  }
  if (!header.fault.empty()) header.slices.clear();
  return header;
}

void read_dicom_densities(const std::string& subject, const DicomHeader& header,
                          const std::function<float*(std::size_t frame)>& frame_densities) {
  silence_gdcm();
  const std::string name = header.file.filename().string();
  try {
    const std::vector<char> buffer = decode(header);
    const std::size_t count =
        static_cast<std::size_t>(header.columns) * static_cast<std::size_t>(header.rows);
    for (const DicomSlice& slice : header.slices) {
      float* densities = frame_densities(slice.frame);
      if (densities != nullptr) rescale_frame(buffer, slice.frame * count, slice.pixels, count, densities);
    }
  } catch (const Fault& fault) {
    throw InputError(subject, name + " " + fault.reason);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {
    throw InputError(subject, fmt::format("{} cannot be decoded ({})", name, codec_name(header)));
  }
}

}  // namespace osteomill
