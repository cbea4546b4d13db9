#include "osteomill/ct/dicom_parser.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace osteomill {

namespace {

constexpr std::uint32_t kUndefinedLength = 0xFFFFFFFF;
constexpr std::uint32_t kItem = 0xFFFEE000;
constexpr std::uint32_t kItemEnd = 0xFFFEE00D;
constexpr std::uint32_t kSequenceEnd = 0xFFFEE0DD;
constexpr int kDeepest = 32;
// No value that is wanted is longer.
constexpr std::uint32_t kLongestValue = 1024;

// Part 5, 7.1.2: these have a 4-byte length in explicit encodings.
bool has_long_length(std::string_view vr) {
  constexpr std::array<std::string_view, 13> kLong{"OB", "OD", "OF", "OL", "OV", "OW", "SQ",
                                                   "SV", "UC", "UN", "UR", "UT", "UV"};
  return std::find(kLong.begin(), kLong.end(), vr) != kLong.end();
}

bool is_wanted(std::uint32_t tag) {
  using namespace dicom_tag;
  constexpr std::array kWanted{kImageType,
                               kInstanceUid,
                               kModality,
                               kSeriesDescription,
                               kSeriesUid,
                               kPosition,
                               kOrientation,
                               kPlanePositionGroup,
                               kPlaneOrientationGroup,
                               kSamplesPerPixel,
                               kPhotometric,
                               kFrames,
                               kRows,
                               kColumns,
                               kPixelSpacing,
                               kBitsAllocated,
                               kBitsStored,
                               kHighBit,
                               kPixelRepresentation,
                               kRescaleIntercept,
                               kRescaleSlope,
                               kModalityTable,
                               kPixelMeasuresGroup,
                               kPixelTransformationGroup,
                               kSharedGroups,
                               kFrameGroups};
  return std::find(kWanted.begin(), kWanted.end(), tag) != kWanted.end();
}

}  // namespace

void DicomParser::seek(std::uint64_t position) {
  position_ = position;
  in_.seekg(static_cast<std::streamoff>(position));
}

void DicomParser::read_meta() {
  while (size_ - position_ >= 8) {
    const std::uint64_t start = position_;
    const Start element = read_start({}, size_);
    if (element.tag >> 16 != 2) {
      seek(start);
      return;
    }
    check_length(element, size_);
    const std::string value = read_value(element.length);
    if (element.tag == dicom_tag::kTransferSyntax) file_.transfer_syntax = value.substr(0, value.find('\0'));
  }
}

void DicomParser::read_elements(const DicomEncoding& encoding, std::uint64_t end, bool until_delimiter,
                                int depth, DicomItem* item) {
  if (depth > kDeepest) throw DicomFault{"is damaged: its sequences are nested too deep"};
  while (position_ < end) {
    // Some writers fill up the end of a file.
    if (end - position_ < 8 && depth == 0) return;
    const Start element = read_start(encoding, end);
    if (element.tag == kItemEnd && until_delimiter) return;
    if (element.tag == dicom_tag::kPixelData && depth == 0) {
      read_pixels(element, encoding, end);
    } else {
      const bool wanted = item != nullptr && is_wanted(element.tag);
      read_element(element, encoding, end, depth, wanted ? &item->elements[element.tag] : nullptr);
    }
  }
  if (until_delimiter) throw DicomFault{"is cut short in a sequence"};
}

void DicomParser::read_element(const Start& element, DicomEncoding encoding, std::uint64_t end, int depth,
                               DicomElement* kept) {
  if (element.length == kUndefinedLength) {
    // A sequence of unknown representation is implicit inside (Part 5, 6.2.2).
    if (element.vr == "UN") encoding.implicit = true;
    read_items(encoding, end, true, depth, kept);
    return;
  }
  check_length(element, end);
  const std::uint64_t after = position_ + element.length;
  if (element.length >= 8 && (element.vr == "SQ" || (element.vr.empty() && next_is_item(encoding)))) {
    read_items(encoding, after, false, depth, kept);
  } else if (kept != nullptr) {
    kept->value = read_value(element.length);
  }
  seek(after);
}

void DicomParser::read_items(const DicomEncoding& encoding, std::uint64_t end, bool until_delimiter,
                             int depth, DicomElement* kept) {
  while (position_ < end) {
    const Start start = read_tag_and_length(encoding, end);
    if (start.tag == kSequenceEnd) return;
    if (start.tag != kItem) throw DicomFault{"is damaged: it has a sequence that is not made of items"};
    DicomItem* item = kept != nullptr ? &kept->items.emplace_back() : nullptr;
    if (start.length == kUndefinedLength) {
      read_elements(encoding, end, true, depth + 1, item);
    } else {
      check_length(start, end);
      read_elements(encoding, position_ + start.length, false, depth + 1, item);
    }
  }
  if (until_delimiter) throw DicomFault{"is cut short in a sequence"};
}

void DicomParser::read_pixels(const Start& element, const DicomEncoding& encoding, std::uint64_t end) {
  file_.pixels = {};
  file_.pixels.compressed = element.length == kUndefinedLength;
  if (!file_.pixels.compressed) {
    file_.pixels.parts.push_back({position_, std::min<std::uint64_t>(element.length, end - position_)});
    if (element.length > end - position_) throw DicomFault{"is cut short: it ends within its pixels"};
    seek(position_ + element.length);
    return;
  }
  while (position_ < end) {
    const Start item = read_tag_and_length(encoding, end);
    if (item.tag == kSequenceEnd) return;
    if (item.tag != kItem) throw DicomFault{"is damaged: its compressed pixels are not made of fragments"};
    if (item.length > end - position_) break;
    file_.pixels.parts.push_back({position_, item.length});
    seek(position_ + item.length);
  }
  throw DicomFault{"is cut short: it ends within its compressed pixels"};
}

bool DicomParser::next_is_item(const DicomEncoding& encoding) {
  const std::uint64_t here = position_;
  const std::uint32_t tag = read_tag(encoding);
  seek(here);
  return tag == kItem;
}

std::string DicomParser::read_value(std::uint32_t length) {
  const std::uint64_t after = position_ + length;
  std::string value(length <= kLongestValue ? length : 0, '\0');
  if (!value.empty()) in_.read(value.data(), static_cast<std::streamsize>(value.size()));
  seek(after);
  return value;
}

DicomParser::Start DicomParser::read_tag_and_length(const DicomEncoding& encoding, std::uint64_t end) {
  if (end - position_ < 8) throw DicomFault{"is cut short"};
  Start element;
  element.tag = read_tag(encoding);
  element.length = read_number(4, encoding);
  return element;
}

DicomParser::Start DicomParser::read_start(const DicomEncoding& encoding, std::uint64_t end) {
  if (encoding.implicit) return read_tag_and_length(encoding, end);
  if (end - position_ < 8) throw DicomFault{"is cut short"};
  Start element;
  element.tag = read_tag(encoding);
  if (element.tag >> 16 == 0xFFFE) {
    element.length = read_number(4, encoding);
    return element;
  }
  std::array<char, 2> vr{};
  in_.read(vr.data(), 2);
  position_ += 2;
  if (!std::isupper(static_cast<unsigned char>(vr[0])) || !std::isupper(static_cast<unsigned char>(vr[1]))) {
    // Implicit elements do turn up in explicit files.
    seek(position_ - 2);
    element.length = read_number(4, encoding);
    return element;
  }
  element.vr.assign(vr.begin(), vr.end());
  if (!has_long_length(element.vr)) {
    element.length = read_number(2, encoding);
    return element;
  }
  if (end - position_ < 6) throw DicomFault{"is cut short"};
  read_number(2, encoding);
  element.length = read_number(4, encoding);
  return element;
}

std::uint32_t DicomParser::read_tag(const DicomEncoding& encoding) {
  const std::uint32_t group = read_number(2, encoding);
  return group << 16 | read_number(2, encoding);
}

std::uint32_t DicomParser::read_number(int bytes, const DicomEncoding& encoding) {
  std::array<unsigned char, 4> raw{};
  if (!in_.read(reinterpret_cast<char*>(raw.data()), bytes)) throw DicomFault{"is cut short"};
  position_ += static_cast<std::uint64_t>(bytes);
  std::uint32_t number = 0;
  for (int n = 0; n < bytes; ++n) {
    const int shift = 8 * (encoding.big_endian ? bytes - 1 - n : n);
    number |= static_cast<std::uint32_t>(raw[static_cast<std::size_t>(n)]) << shift;
  }
  return number;
}

void DicomParser::check_length(const Start& element, std::uint64_t end) const {
  if (element.length > end - position_) {
    throw DicomFault{"is cut short or damaged: an element is longer than what is left of it"};
  }
}

}  // namespace osteomill
