#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace osteomill {

/// The tags that place a slice and say what its pixels mean: group in the upper, element in the lower 16
/// bits.
namespace dicom_tag {
inline constexpr std::uint32_t kTransferSyntax = 0x00020010;
inline constexpr std::uint32_t kImageType = 0x00080008;
inline constexpr std::uint32_t kInstanceUid = 0x00080018;
inline constexpr std::uint32_t kModality = 0x00080060;
inline constexpr std::uint32_t kSeriesDescription = 0x0008103E;
inline constexpr std::uint32_t kSeriesUid = 0x0020000E;
inline constexpr std::uint32_t kPosition = 0x00200032;
inline constexpr std::uint32_t kOrientation = 0x00200037;
inline constexpr std::uint32_t kPlanePositionGroup = 0x00209113;
inline constexpr std::uint32_t kPlaneOrientationGroup = 0x00209116;
inline constexpr std::uint32_t kSamplesPerPixel = 0x00280002;
inline constexpr std::uint32_t kPhotometric = 0x00280004;
inline constexpr std::uint32_t kFrames = 0x00280008;
inline constexpr std::uint32_t kRows = 0x00280010;
inline constexpr std::uint32_t kColumns = 0x00280011;
inline constexpr std::uint32_t kPixelSpacing = 0x00280030;
inline constexpr std::uint32_t kBitsAllocated = 0x00280100;
inline constexpr std::uint32_t kBitsStored = 0x00280101;
inline constexpr std::uint32_t kHighBit = 0x00280102;
inline constexpr std::uint32_t kPixelRepresentation = 0x00280103;
inline constexpr std::uint32_t kRescaleIntercept = 0x00281052;
inline constexpr std::uint32_t kRescaleSlope = 0x00281053;
inline constexpr std::uint32_t kModalityTable = 0x00283000;
inline constexpr std::uint32_t kPixelMeasuresGroup = 0x00289110;
inline constexpr std::uint32_t kPixelTransformationGroup = 0x00289145;
inline constexpr std::uint32_t kSharedGroups = 0x52009229;
inline constexpr std::uint32_t kFrameGroups = 0x52009230;
inline constexpr std::uint32_t kPixelData = 0x7FE00010;
}  // namespace dicom_tag

struct DicomItem;

struct DicomElement {
  /// As stored; empty where it is longer than any value that is wanted.
  std::string value;
  /// Of a sequence.
  std::vector<DicomItem> items;
};

/// A data set, or an item of a sequence: those of its elements that have a name above.
struct DicomItem {
  std::map<std::uint32_t, DicomElement> elements;
};

/// Where the pixels lie in the stream of `open_dicom_data`.
struct DicomPixels {
  struct Part {
    std::uint64_t offset = 0;
    std::uint64_t length = 0;
  };
  bool compressed = false;
  /// One part where the pixels are not compressed; else the table of offsets and then the fragments.
  std::vector<Part> parts;

  std::uint64_t bytes() const {
    std::uint64_t sum = 0;
    for (const Part& part : parts) sum += part.length;
    return sum;
  }
};

/// What a DICOM file holds, its pixels left where they are.
struct DicomFile {
  /// Empty where the file has no meta group.
  std::string transfer_syntax;
  bool big_endian = false;
  DicomItem data;
  DicomPixels pixels;
  /// Why the file is damaged: an element that is longer than what is left of it, say. Elements read before
  /// that stand.
  std::optional<std::string> fault;
};

/// Reads a DICOM file; nothing where it is not DICOM at all. Nothing is allocated that the file does not
/// hold. (GDCM's own reader allocates whatever a damaged length says, and aborts the program in failed
/// assertions; so it is given pixels alone.) Throws InputError only where the file cannot be opened.
std::optional<DicomFile> read_dicom_elements(const std::filesystem::path& path);

/// The stream to which the offsets of `DicomPixels` belong. Throws InputError where the file has gone.
std::unique_ptr<std::istream> open_dicom_data(const std::filesystem::path& path);

}  // namespace osteomill
