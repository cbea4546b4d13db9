#include "dicom_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <dcmtk/dcmdata/dctk.h>
#include <fmt/format.h>

#include "dicom_data.h"
#include "dicom_text.h"
#include "header_text.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// Limit on the size that compressed pixels may claim: this constant plus kMaxCompression times their stored
// size. Blank slices compress strongly.
constexpr std::uint64_t kAlwaysAllowed_bytes = 1 << 26;
constexpr std::uint64_t kMaxCompression = 2000;

const std::array<DcmTagKey, 3> kPlaceTags{DCM_PixelSpacing, DCM_ImagePositionPatient,
                                          DCM_ImageOrientationPatient};

std::string text_of(DcmItem& data, const DcmTagKey& tag) {
  OFString text;
  if (data.findAndGetOFStringArray(tag, text).bad()) return {};
  return trimmed(text.c_str());
}

std::optional<int> short_of(DcmItem& data, const DcmTagKey& tag) {
  Uint16 number = 0;
  if (data.findAndGetUint16(tag, number).bad()) return std::nullopt;
  return number;
}

// Element with a mark of a slice, and the functional group that contains it for a frame.
struct MarkTag {
  DcmTagKey group;
  DcmTagKey tag;
};

// In the order of kMarkKinds; a mark may be in one of several elements.
const std::array<std::vector<MarkTag>, kMarkKinds.size()>& mark_tags() {
  const DcmTagKey none = DCM_UndefinedTagKey;
  static const std::array<std::vector<MarkTag>, kMarkKinds.size()> tags{
      {{{none, DCM_Modality}},
       {{none, DCM_StudyInstanceUID}},
       {{none, DCM_SeriesNumber}},
       {{DCM_CTImageFrameTypeSequence, DCM_FrameType}, {none, DCM_ImageType}},
       {{DCM_FrameContentSequence, DCM_StackID}},
       {{DCM_FrameContentSequence, DCM_TemporalPositionIndex}, {none, DCM_TemporalPositionIdentifier}},
       {{none, DCM_FrameReferenceTime}},
       {{DCM_CardiacSynchronizationSequence, DCM_NominalPercentageOfCardiacPhase}},
       {{DCM_FrameContentSequence, DCM_FrameAcquisitionNumber}, {none, DCM_AcquisitionNumber}},
       {{none, DCM_SeriesTime}},
       {{none, DCM_FrameOfReferenceUID}},
       {{none, DCM_PatientPosition}},
       {{none, DCM_SeriesDescription}},
       {{none, DCM_ProtocolName}},
       {{DCM_MREchoSequence, DCM_EffectiveEchoTime}, {none, DCM_EchoTime}},
       {{none, DCM_EchoNumbers}},
       {{none, DCM_InversionTime}},
       {{none, DCM_FlipAngle}},
       {{none, DCM_ContrastBolusAgent}},
       {{DCM_CTXRayDetailsSequence, DCM_KVP}},
       {{DCM_CTXRayDetailsSequence, DCM_FilterType}},
       {{DCM_CTReconstructionSequence, DCM_ConvolutionKernel}},
       {{DCM_CTReconstructionSequence, DCM_ReconstructionDiameter}},
       {{DCM_MRDiffusionSequence, DCM_DiffusionBValue}},
       {{DCM_PixelMeasuresSequence, DCM_SliceThickness}},
       {{DCM_FrameContentSequence, DCM_FrameAcquisitionDateTime},
        {none, DCM_AcquisitionDateTime},
        {none, DCM_AcquisitionTime}},
       {{DCM_CardiacSynchronizationSequence, DCM_NominalCardiacTriggerDelayTime}, {none, DCM_TriggerTime}},
       {{none, DCM_ContentTime}},
       {{none, DCM_InstanceNumber}}}};
  return tags;
}

// Returns the number of decimals of each of three numbers.
std::array<int, 3> decimals_of(std::string_view text) {
  std::array<int, 3> decimals{};
  for (int& of : decimals) {
    const std::string_view number = text.substr(0, text.find('\\'));
    text.remove_prefix(std::min(number.size() + 1, text.size()));
    const std::size_t power = number.find_first_of("eE");
    const std::string_view digits = number.substr(0, power);
    const std::size_t point = digits.find('.');
    if (point != std::string_view::npos) of = static_cast<int>(trimmed(digits.substr(point + 1)).size());
    if (power != std::string_view::npos)
      of -= parse_number<int>(trimmed(number.substr(power + 1))).value_or(0);
    of = std::clamp(of, 0, 16);
  }
  return decimals;
}

// Returns the items of a sequence; empty if the sequence is missing.
std::vector<DcmItem*> items_of(DcmItem& data, const DcmTagKey& tag) {
  std::vector<DcmItem*> items;
  DcmSequenceOfItems* sequence = nullptr;
  if (data.findAndGetSequence(tag, sequence).bad()) return items;
  for (DcmObject* item = nullptr; (item = sequence->nextInContainer(item)) != nullptr;) {
    items.push_back(static_cast<DcmItem*>(item));
  }
  return items;
}

// Reads the header of one file.
class FileReader {
 public:
  FileReader(DcmDataset& data, DicomHeader& header)
      : data_(data),
        header_(header),
        shared_(items_of(data, DCM_SharedFunctionalGroupsSequence)),
        own_(items_of(data, DCM_PerFrameFunctionalGroupsSequence)) {}

  void read_frames();

 private:
  InputError fault(const std::string& reason) const { return {header_.file.string(), reason}; }

  std::optional<std::vector<double>> numbers(DcmItem& data, const DcmTagKey& tag, std::size_t count,
                                             const char* name) const;
  // Returns the items that may contain a value of the frame, in order: its own functional group, the shared
  // one, the data set.
  std::vector<DcmItem*> groups_of(std::size_t frame, const DcmTagKey& group) const;
  std::optional<std::vector<double>> frame_numbers(std::size_t frame, const DcmTagKey& group,
                                                   const DcmTagKey& tag, std::size_t count,
                                                   const char* name) const;
  std::string frame_text(std::size_t frame, const DcmTagKey& group, const DcmTagKey& tag) const;
  SliceMarks marks_of(std::size_t frame) const;
  // Returns why the picture is not a slice of a scan; empty if it may be one.
  std::string no_slice() const;
  StoredPixels stored_pixels() const;
  std::optional<Padding> padding_of(const StoredPixels& pixels) const;
  SlicePlane plane_of(std::size_t frame) const;
  DicomSlice slice_of(std::size_t frame) const;
  void describe_segments();
  bool has_frame_places() const;
  // Handles old multi-frame images, as from cone-beam CT, which give the position of the first frame and the
  // distance between frames.
  void place_frames();
  void check_byte_count() const;

  DcmDataset& data_;
  DicomHeader& header_;
  std::vector<DcmItem*> shared_;
  std::vector<DcmItem*> own_;
  // Distance of each frame from the first along the normal; empty if each has a position of its own.
  std::vector<double> offsets_mm_;
};

std::optional<std::vector<double>> FileReader::numbers(DcmItem& data, const DcmTagKey& tag, std::size_t count,
                                                       const char* name) const {
  const std::string text = text_of(data, tag);
  if (text.empty()) return std::nullopt;
  std::optional<std::vector<double>> values = parse_numbers(text, " \\");
  if (!values || values->size() != count) {
    throw fault(fmt::format("has a {} that is not {} number{}", name, count, count == 1 ? "" : "s"));
  }
  for (const double value : *values) {
    if (!std::isfinite(value)) throw fault(fmt::format("has a {} that is not finite", name));
  }
  return values;
}

std::vector<DcmItem*> FileReader::groups_of(std::size_t frame, const DcmTagKey& group) const {
  std::vector<DcmItem*> found;
  for (DcmItem* outer :
       {frame < own_.size() ? own_[frame] : nullptr, shared_.empty() ? nullptr : shared_[0]}) {
    DcmItem* inner = nullptr;
    if (outer != nullptr && outer->findAndGetSequenceItem(group, inner).good()) found.push_back(inner);
  }
  found.push_back(&data_);
  return found;
}

std::optional<std::vector<double>> FileReader::frame_numbers(std::size_t frame, const DcmTagKey& group,
                                                             const DcmTagKey& tag, std::size_t count,
                                                             const char* name) const {
  for (DcmItem* place : groups_of(frame, group)) {
    if (auto found = numbers(*place, tag, count, name)) return found;
  }
  return std::nullopt;
}

std::string FileReader::frame_text(std::size_t frame, const DcmTagKey& group, const DcmTagKey& tag) const {
  for (DcmItem* place : groups_of(frame, group)) {
    if (std::string text = display_text(*place, tag); !text.empty()) return text;
  }
  return {};
}

SliceMarks FileReader::marks_of(std::size_t frame) const {
  SliceMarks marks;
  for (std::size_t mark = 0; mark < marks.size(); ++mark) {
    for (const MarkTag& place : mark_tags()[mark]) {
      if (marks[mark].empty()) marks[mark] = frame_text(frame, place.group, place.tag);
    }
  }
  return marks;
}

std::string FileReader::no_slice() const {
  const bool is_grey = header_.photometric.starts_with("MONOCHROME") ||
                       (header_.is_segmentation && header_.photometric.starts_with("PALETTE"));
  if (short_of(data_, DCM_SamplesPerPixel).value_or(1) != 1 || !is_grey)
    return fmt::format("a colour image ({})", header_.photometric);
  const bool has_place = std::any_of(kPlaceTags.begin(), kPlaceTags.end(),
                                     [&](const DcmTagKey& tag) { return !text_of(data_, tag).empty(); });
  return has_place || header_.frames > 1 ? "" : "a picture without a position";
}

// Returns the lowest `bits_allocated` bits of an element's number, so that it does not matter whether the
// file declares it signed.
std::optional<std::uint32_t> word_of(DcmItem& data, const DcmTagKey& tag, int bits_allocated) {
  const auto value = parse_number<long long>(text_of(data, tag));
  if (!value) return std::nullopt;
  return static_cast<std::uint32_t>(*value) & 0xFFFFFFFFU >> (32 - bits_allocated);
}

// Returns the value of a word stored as a pixel; nullopt if no pixel can have it.
std::optional<double> stored_value_of(std::uint32_t word, const StoredPixels& pixels) {
  const double value = value_of(word, pixels);
  const std::uint32_t stored = word & 0xFFFFFFFFU >> (32 - pixels.bits_stored);
  const std::uint32_t extended = static_cast<std::uint32_t>(static_cast<std::int64_t>(value)) &
                                 0xFFFFFFFFU >> (32 - pixels.bits_allocated);
  return word == stored || word == extended ? std::optional(value) : std::nullopt;
}

std::optional<Padding> FileReader::padding_of(const StoredPixels& pixels) const {
  const auto range = [](double one, double other) {
    return Padding{{}, std::min(one, other), std::max(one, other)};
  };
  if (pixels.is_float) {
    const bool is_double = pixels.bits_allocated == 64;
    const auto number = [&](const DcmTagKey& of_float, const DcmTagKey& of_double) {
      return parse_number<double>(text_of(data_, is_double ? of_double : of_float));
    };
    const auto value = number(DCM_FloatPixelPaddingValue, DCM_DoubleFloatPixelPaddingValue);
    if (!value) return std::nullopt;
    return range(
        *value,
        number(DCM_FloatPixelPaddingRangeLimit, DCM_DoubleFloatPixelPaddingRangeLimit).value_or(*value));
  }
  const auto word = word_of(data_, DCM_PixelPaddingValue, pixels.bits_allocated);
  if (!word) return std::nullopt;
  Padding padding;
  if (const auto value = stored_value_of(*word, pixels)) {
    padding = range(*value, *value);
    const auto limit = word_of(data_, DCM_PixelPaddingRangeLimit, pixels.bits_allocated);
    if (const auto end = limit ? stored_value_of(*limit, pixels) : std::nullopt)
      padding = range(*value, *end);
  }
  padding.word = word;
  return padding;
}

// Converts CIELab as encoded in DICOM (Part 3, C.10.7.1.1; white point D50) to sRGB.
std::array<std::uint8_t, 3> colour_of(const std::array<double, 3>& lab) {
  const double lightness = (100 * lab[0] / 65535 + 16) / 116;
  const auto part = [](double f) { return f > 6.0 / 29 ? f * f * f : (f - 16.0 / 116) * 108 / 841; };
  const Vec3 white(0.9642, 1, 0.8249);
  const Vec3 xyz =
      white.cwiseProduct(Vec3(part(lightness + (255 * lab[1] / 65535 - 128) / 500), part(lightness),
                              part(lightness - (255 * lab[2] / 65535 - 128) / 200)));
  Mat3 srgb_from_xyz;
  srgb_from_xyz << 3.1338561, -1.6168667, -0.4906146, -0.9787684, 1.9161415, 0.0334540, 0.0719453, -0.2289914,
      1.4052427;
  const Vec3 linear = srgb_from_xyz * xyz;
  std::array<std::uint8_t, 3> colour{};
  for (std::size_t n = 0; n < 3; ++n) {
    const double light = std::clamp(linear[static_cast<Eigen::Index>(n)], 0.0, 1.0);
    const double level = light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
    colour[n] = static_cast<std::uint8_t>(std::lround(255 * level));
  }
  return colour;
}

std::vector<LabelName> segments_of(DcmItem& data) {
  std::vector<LabelName> segments;
  for (DcmItem* item : items_of(data, DCM_SegmentSequence)) {
    LabelName segment{short_of(*item, DCM_SegmentNumber).value_or(0), display_text(*item, DCM_SegmentLabel)};
    std::array<double, 3> lab{};
    bool has_colour = true;
    for (unsigned long n = 0; n < 3; ++n) {
      Uint16 level = 0;
      has_colour = has_colour && item->findAndGetUint16(DCM_RecommendedDisplayCIELabValue, level, n).good();
      lab[n] = level;
    }
    if (has_colour) segment.colour = colour_of(lab);
    segments.push_back(std::move(segment));
  }
  return segments;
}

void FileReader::describe_segments() {
  header_.segments = segments_of(data_);
  const auto distance = [&](const DcmTagKey& tag, const char* name) {
    const auto found = frame_numbers(0, DCM_PixelMeasuresSequence, tag, 1, name);
    return found ? found->front() : 0;
  };
  header_.slice_distance_mm = distance(DCM_SpacingBetweenSlices, "SpacingBetweenSlices");
  if (header_.slice_distance_mm == 0)
    header_.slice_distance_mm = distance(DCM_SliceThickness, "SliceThickness");
  const std::string type = text_of(data_, DCM_SegmentationType);
  if (type == "FRACTIONAL")
    header_.least_segment_value =
        0.5F * static_cast<float>(short_of(data_, DCM_MaximumFractionalValue).value_or(255));
  for (std::size_t frame = 0; frame < header_.slices.size() && type != "LABELMAP"; ++frame) {
    const auto segment =
        frame_numbers(frame, DCM_SegmentIdentificationSequence, DCM_ReferencedSegmentNumber, 1, "segment");
    if (!segment) throw fault("is a segmentation that does not state the segments of its frames");
    header_.slices[frame].segment = static_cast<int>(segment->front());
  }
}

StoredPixels FileReader::stored_pixels() const {
  StoredPixels pixels;
  pixels.bits_allocated = short_of(data_, DCM_BitsAllocated).value_or(0);
  pixels.bits_stored = short_of(data_, DCM_BitsStored).value_or(pixels.bits_allocated);
  pixels.is_signed = short_of(data_, DCM_PixelRepresentation).value_or(0) == 1;
  pixels.is_float = !data_.tagExists(DCM_PixelData);
  if (pixels.is_float) {
    if (pixels.bits_allocated != (data_.tagExists(DCM_FloatPixelData) ? 32 : 64))
      throw fault(fmt::format("has floats of {} bits", pixels.bits_allocated));
    pixels.padding = padding_of(pixels);
    return pixels;
  }
  if (header_.is_segmentation && pixels.bits_allocated == 1) return pixels;
  const int high_bit = short_of(data_, DCM_HighBit).value_or(pixels.bits_stored - 1);
  const bool whole_bytes =
      pixels.bits_allocated == 8 || pixels.bits_allocated == 16 || pixels.bits_allocated == 32;
  if (!whole_bytes || pixels.bits_stored < 1 || pixels.bits_stored > pixels.bits_allocated ||
      high_bit != pixels.bits_stored - 1) {
    throw fault(fmt::format("has pixels of {} bits in {} with high bit {}, which is not supported",
                            pixels.bits_stored, pixels.bits_allocated, high_bit));
  }
  pixels.padding = padding_of(pixels);
  return pixels;
}

SlicePlane FileReader::plane_of(std::size_t frame) const {
  const auto spacing = frame_numbers(frame, DCM_PixelMeasuresSequence, DCM_PixelSpacing, 2, "PixelSpacing");
  if (!spacing) throw fault("has no PixelSpacing, so its size is unknown");
  const auto position =
      frame_numbers(frame, DCM_PlanePositionSequence, DCM_ImagePositionPatient, 3, "ImagePositionPatient");
  if (!position) throw fault("has no ImagePositionPatient, so its position is unknown");
  const auto orientation = frame_numbers(frame, DCM_PlaneOrientationSequence, DCM_ImageOrientationPatient, 6,
                                         "ImageOrientationPatient");
  if (!orientation) throw fault("has no ImageOrientationPatient, so its orientation is unknown");

  SlicePlane plane;
  plane.columns = header_.columns;
  plane.rows = header_.rows;
  // PixelSpacing is the row distance, then the column distance (Part 3, 10.7.1.3).
  plane.row_distance_mm = (*spacing)[0];
  plane.column_distance_mm = (*spacing)[1];
  plane.i_direction = Vec3(orientation->data());
  plane.j_direction = Vec3(orientation->data() + 3);
  plane.position_mm = Vec3(position->data());
  if (!offsets_mm_.empty())
    plane.position_mm += plane.i_direction.cross(plane.j_direction) * offsets_mm_[frame];
  plane.decimals = decimals_of(frame_text(frame, DCM_PlanePositionSequence, DCM_ImagePositionPatient));
  if (header_.frames == 1) plane.number = parse_number<int>(text_of(data_, DCM_InstanceNumber));
  return plane;
}

DicomSlice FileReader::slice_of(std::size_t frame) const {
  DicomSlice slice;
  slice.plane = plane_of(frame);
  const std::string instance_uid = text_of(data_, DCM_SOPInstanceUID);
  const std::string file_name = header_.file.filename().string();
  slice.plane.name = header_.frames == 1 ? file_name : fmt::format("{} frame {}", file_name, frame + 1);
  slice.plane.instance = instance_uid.empty() ? "" : fmt::format("{}#{}", instance_uid, frame);
  slice.pixels = stored_pixels();
  slice.marks = marks_of(frame);
  const auto rescale = [&](const DcmTagKey& tag, const char* name) {
    return frame_numbers(frame, DCM_PixelValueTransformationSequence, tag, 1, name);
  };
  if (const auto slope = rescale(DCM_RescaleSlope, "RescaleSlope")) slice.pixels.slope = slope->front();
  if (const auto intercept = rescale(DCM_RescaleIntercept, "RescaleIntercept"))
    slice.pixels.intercept = intercept->front();
  if (slice.pixels.slope == 0) throw fault("has a RescaleSlope of 0, which makes all densities equal");
  return slice;
}

bool FileReader::has_frame_places() const {
  const auto has_place = [](DcmItem* groups) {
    DcmItem* place = nullptr;
    return groups->findAndGetSequenceItem(DCM_PlanePositionSequence, place).good();
  };
  return !own_.empty() && (std::any_of(own_.begin(), own_.end(), has_place) ||
                           std::any_of(shared_.begin(), shared_.end(), has_place));
}

void FileReader::place_frames() {
  DcmElement* pointer = nullptr;
  DcmTagKey along;
  // Frames of a film are ordered by time.
  if (data_.findAndGetElement(DCM_FrameIncrementPointer, pointer).good() &&
      pointer->getTagVal(along, 0).good() && along != DCM_SliceLocationVector) {
    throw fault(fmt::format("has several frames ordered by {}, not by position", DcmTag(along).getTagName()));
  }
  if (const auto heights_mm =
          numbers(data_, DCM_SliceLocationVector, header_.frames, "SliceLocationVector")) {
    for (const double height_mm : *heights_mm) offsets_mm_.push_back(height_mm - heights_mm->front());
  } else if (const auto spacing_mm = frame_numbers(0, DCM_PixelMeasuresSequence, DCM_SpacingBetweenSlices, 1,
                                                   "SpacingBetweenSlices")) {
    for (std::size_t frame = 0; frame < header_.frames; ++frame)
      offsets_mm_.push_back(spacing_mm->front() * static_cast<double>(frame));
  } else {
    throw fault("has several frames without positions");
  }
  header_.warning = fmt::format(
      "its frames have no positions of their own: they were placed along the normal, the second {:.6g} mm "
      "from the first",
      offsets_mm_[1]);
}

void FileReader::check_byte_count() const {
  const std::uint64_t needed =
      (static_cast<std::uint64_t>(header_.columns) * static_cast<std::uint64_t>(header_.rows) *
           header_.frames * static_cast<std::uint64_t>(stored_pixels().bits_allocated) +
       7) /
      8;
  const std::uint64_t stored = header_.pixel_bytes;
  const std::uint64_t possible =
      header_.is_compressed ? stored * kMaxCompression + kAlwaysAllowed_bytes : stored;
  if (needed > possible) {
    throw fault(fmt::format(
        "is cut short: {} x {} pixels{} need {} bytes, it holds {}", header_.columns, header_.rows,
        header_.frames > 1 ? fmt::format(" x {} frames", header_.frames) : "", needed, stored));
  }
}

void FileReader::read_frames() {
  if (const auto frames = numbers(data_, DCM_NumberOfFrames, 1, "NumberOfFrames")) {
    if (frames->front() < 1 || frames->front() > 1 << 16) throw fault("has an invalid NumberOfFrames");
    header_.frames = static_cast<std::size_t>(frames->front());
  }
  if (!header_.undecodable.empty() && header_.is_image())
    throw fault(fmt::format("is encoded as {}, which is not supported", header_.undecodable));
  if (header_.pixel_bytes == 0) throw fault("has no pixels");
  if (header_.columns < 1 || header_.rows < 1) {
    throw fault(fmt::format("has no size: {} columns x {} rows", header_.columns, header_.rows));
  }
  header_.no_slice = no_slice();
  if (header_.no_slice.starts_with("a colour"))
    throw fault(fmt::format("is {}, not a scan", header_.no_slice));
  if (data_.tagExists(DCM_ModalityLUTSequence))
    throw fault("needs a modality lookup table, which is not supported");
  if (header_.frames > 1 && !has_frame_places()) place_frames();
  check_byte_count();
  std::string unit;
  for (DcmItem* place : groups_of(0, DCM_PixelValueTransformationSequence)) {
    if (unit.empty()) unit = text_of(*place, DCM_RescaleType);
  }
  header_.in_hounsfield_units = header_.modality == "CT" && (unit.empty() || unit == "HU");
  for (std::size_t frame = 0; frame < header_.frames; ++frame) {
    header_.slices.push_back(slice_of(frame));
  }
  if (header_.is_segmentation) describe_segments();
}

std::uint64_t bytes_of_pixels(DcmDataset& data, bool is_compressed) {
  DcmElement* pixels = nullptr;
  const bool found = data.findAndGetElement(DCM_PixelData, pixels).good() ||
                     data.findAndGetElement(DCM_FloatPixelData, pixels).good() ||
                     data.findAndGetElement(DCM_DoubleFloatPixelData, pixels).good();
  if (!found) return 0;
  if (!is_compressed) return pixels->getLength();
  std::uint64_t bytes = 0;
  const std::vector<DcmPixelItem*> items = pixel_items_of(data);
  for (std::size_t n = 1; n < items.size(); ++n) bytes += items[n]->getLength();
  return bytes;
}

// Returns the images that a DICOMDIR lists. Valid names have only capitals, digits and underscores (Part 10,
// 8.2); ignores names that would lead out of the folder.
std::vector<fs::path> listed_files(DcmDataset& data) {
  std::vector<fs::path> files;
  for (DcmItem* record : items_of(data, DCM_DirectoryRecordSequence)) {
    if (text_of(*record, DCM_DirectoryRecordType) != "IMAGE") continue;
    std::string name = text_of(*record, DCM_ReferencedFileID);
    std::replace(name.begin(), name.end(), '\\', '/');
    if (name.empty() || name.front() == '/' || name.find("..") != std::string::npos) continue;
    files.emplace_back(name);
  }
  return files;
}

void describe(DcmDataset& data, DicomHeader& header) {
  header.is_compressed = DcmXfer(header.syntax.c_str()).isEncapsulated();
  header.pixel_bytes = bytes_of_pixels(data, header.is_compressed);
  header.series_uid = display_text(data, DCM_SeriesInstanceUID);
  header.series_description = display_text(data, DCM_SeriesDescription);
  header.modality = display_text(data, DCM_Modality);
  header.photometric = display_text(data, DCM_PhotometricInterpretation);
  header.columns = short_of(data, DCM_Columns).value_or(0);
  header.rows = short_of(data, DCM_Rows).value_or(0);
  header.listed_files = listed_files(data);
  const std::string kind = text_of(data, DCM_SOPClassUID);
  // Segmentation and label map storage; DCMTK 3.6.7 has no name for the latter.
  header.is_segmentation = kind == UID_SegmentationStorage || kind == "1.2.840.10008.5.1.4.1.1.66.7";
  if (const std::string uid = text_of(data, DCM_ConcatenationUID); !uid.empty()) {
    header.concatenation = {uid, short_of(data, DCM_InConcatenationNumber).value_or(0),
                            short_of(data, DCM_InConcatenationTotalNumber).value_or(0)};
  }
  header.is_localizer = text_of(data, DCM_ImageType).find("LOCALIZER") != std::string::npos;
}

}  // namespace

std::vector<DcmPixelItem*> pixel_items_of(DcmDataset& data) {
  std::vector<DcmPixelItem*> items;
  DcmElement* element = nullptr;
  DcmPixelSequence* sequence = nullptr;
  if (data.findAndGetElement(DCM_PixelData, element).bad()) return items;
  auto* pixels = dynamic_cast<DcmPixelData*>(element);
  if (pixels == nullptr) return items;
  E_TransferSyntax syntax = EXS_Unknown;
  const DcmRepresentationParameter* parameter = nullptr;
  pixels->getOriginalRepresentationKey(syntax, parameter);
  if (pixels->getEncapsulatedRepresentation(syntax, parameter, sequence).bad() || sequence == nullptr)
    return items;
  for (DcmObject* item = nullptr; (item = sequence->nextInContainer(item)) != nullptr;) {
    items.push_back(static_cast<DcmPixelItem*>(item));
  }
  return items;
}

std::optional<DicomHeader> read_dicom_header(const fs::path& path, std::uint64_t max_bytes) {
  DicomHeader header;
  header.file = path;
  header.lost = true;
  try {
    std::optional<DicomData> loaded = load_dicom(path, max_bytes);
    if (!loaded) return std::nullopt;
    header.data = std::move(loaded->file);
    header.syntax = std::move(loaded->syntax);
    header.undecodable = std::move(loaded->undecodable);
    DcmDataset& data = *header.data->getDataset();
    describe(data, header);
    // A file in an unknown encoding may look damaged.
    const bool is_known = header.undecodable.empty();
    header.lost = loaded->damaged && header.pixel_bytes == 0 && (is_known || !header.is_image());
    if (loaded->damaged) {
      throw InputError(path.string(), is_known ? "is cut short or damaged"
                                               : fmt::format("is encoded as {}, which is not supported",
                                                             header.undecodable));
    }
    if (!header.is_directory()) FileReader(data, header).read_frames();
  } catch (const InputError& fault) {
    header.fault = fault;
    header.slices.clear();
  }
  return header;
}

}  // namespace osteomill
