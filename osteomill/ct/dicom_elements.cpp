#include "osteomill/ct/dicom_elements.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <sstream>
#include <string_view>

#include "osteomill/ct/inflate.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kUndefinedLength = 0xFFFFFFFF;
constexpr std::uint32_t kItem = 0xFFFEE000;
constexpr std::uint32_t kItemEnd = 0xFFFEE00D;
constexpr std::uint32_t kSequenceEnd = 0xFFFEE0DD;
constexpr int kDeepest = 32;
// No value that is wanted is longer.
constexpr std::uint32_t kLongestValue = 1024;
// Images come down to a tenth or so; what would grow more than this is damaged or meant to fill the memory.
constexpr std::uint64_t kMostInflation = 100;

struct Fault {
  std::string reason;
};

struct Encoding {
  bool implicit = false;
  bool big_endian = false;
};

struct ElementStart {
  std::uint32_t tag = 0;
  std::string vr;
  std::uint32_t length = 0;
};

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

class Parser {
 public:
  Parser(std::istream& in, std::uint64_t size, DicomFile& file) : in_(in), size_(size), file_(file) {}

  std::uint64_t position() const { return position_; }
  void seek(std::uint64_t position) {
    position_ = position;
    in_.seekg(static_cast<std::streamoff>(position));
  }

  // The meta group: always explicit little endian.
  void read_meta() {
    while (size_ - position_ >= 8) {
      const std::uint64_t start = position_;
      const ElementStart element = read_start({}, size_);
      if (element.tag >> 16 != 2) {
        seek(start);
        return;
      }
      check_length(element, size_);
      const std::string value = read_value(element.length);
      if (element.tag == dicom_tag::kTransferSyntax)
        file_.transfer_syntax = value.substr(0, value.find('\0'));
    }
  }

  void read_data_set(Encoding encoding) { read_elements(encoding, size_, false, 0, &file_.data); }

 private:
  // Up to `end`, or to the delimiter of an item without a length. No `item`: only to see where it ends.
  void read_elements(Encoding encoding, std::uint64_t end, bool until_delimiter, int depth, DicomItem* item) {
    if (depth > kDeepest) throw Fault{"is damaged: its sequences are nested too deep"};
    while (position_ < end) {
      // Some writers fill up the end of a file.
      if (end - position_ < 8 && depth == 0) return;
      const ElementStart element = read_start(encoding, end);
      if (element.tag == kItemEnd && until_delimiter) return;
      if (element.tag == dicom_tag::kPixelData && depth == 0) {
        read_pixels(element, encoding, end);
      } else {
        const bool wanted = item != nullptr && is_wanted(element.tag);
        read_element(element, encoding, end, depth, wanted ? &item->elements[element.tag] : nullptr);
      }
    }
    if (until_delimiter) throw Fault{"is cut short in a sequence"};
  }

  void read_element(const ElementStart& element, Encoding encoding, std::uint64_t end, int depth,
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

  void read_items(Encoding encoding, std::uint64_t end, bool until_delimiter, int depth, DicomElement* kept) {
    while (position_ < end) {
      const ElementStart start = read_tag_and_length(encoding, end);
      if (start.tag == kSequenceEnd) return;
      if (start.tag != kItem) throw Fault{"is damaged: it has a sequence that is not made of items"};
      DicomItem* item = kept != nullptr ? &kept->items.emplace_back() : nullptr;
      if (start.length == kUndefinedLength) {
        read_elements(encoding, end, true, depth + 1, item);
      } else {
        check_length(start, end);
        read_elements(encoding, position_ + start.length, false, depth + 1, item);
      }
    }
    if (until_delimiter) throw Fault{"is cut short in a sequence"};
  }

  void read_pixels(const ElementStart& element, Encoding encoding, std::uint64_t end) {
    file_.pixels = {};
    file_.pixels.compressed = element.length == kUndefinedLength;
    if (!file_.pixels.compressed) {
      file_.pixels.parts.push_back({position_, std::min<std::uint64_t>(element.length, end - position_)});
      if (element.length > end - position_) throw Fault{"is cut short: it ends within its pixels"};
      seek(position_ + element.length);
      return;
    }
    while (position_ < end) {
      const ElementStart item = read_tag_and_length(encoding, end);
      if (item.tag == kSequenceEnd) return;
      if (item.tag != kItem) throw Fault{"is damaged: its compressed pixels are not made of fragments"};
      if (item.length > end - position_) break;
      file_.pixels.parts.push_back({position_, item.length});
      seek(position_ + item.length);
    }
    throw Fault{"is cut short: it ends within its compressed pixels"};
  }

  bool next_is_item(Encoding encoding) {
    const std::uint64_t here = position_;
    const std::uint32_t tag = read_tag(encoding);
    seek(here);
    return tag == kItem;
  }

  std::string read_value(std::uint32_t length) {
    const std::uint64_t after = position_ + length;
    std::string value(length <= kLongestValue ? length : 0, '\0');
    if (!value.empty()) in_.read(value.data(), static_cast<std::streamsize>(value.size()));
    seek(after);
    return value;
  }

  ElementStart read_tag_and_length(Encoding encoding, std::uint64_t end) {
    if (end - position_ < 8) throw Fault{"is cut short"};
    ElementStart element;
    element.tag = read_tag(encoding);
    element.length = read_number(4, encoding);
    return element;
  }

  ElementStart read_start(Encoding encoding, std::uint64_t end) {
    if (encoding.implicit) return read_tag_and_length(encoding, end);
    if (end - position_ < 8) throw Fault{"is cut short"};
    ElementStart element;
    element.tag = read_tag(encoding);
    if (element.tag >> 16 == 0xFFFE) {
      element.length = read_number(4, encoding);
      return element;
    }
    std::array<char, 2> vr{};
    in_.read(vr.data(), 2);
    position_ += 2;
    if (!std::isupper(static_cast<unsigned char>(vr[0])) ||
        !std::isupper(static_cast<unsigned char>(vr[1]))) {
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
    if (end - position_ < 6) throw Fault{"is cut short"};
    read_number(2, encoding);
    element.length = read_number(4, encoding);
    return element;
  }

  std::uint32_t read_tag(Encoding encoding) {
    const std::uint32_t group = read_number(2, encoding);
    return group << 16 | read_number(2, encoding);
  }

  std::uint32_t read_number(int bytes, Encoding encoding) {
    std::array<unsigned char, 4> raw{};
    if (!in_.read(reinterpret_cast<char*>(raw.data()), bytes)) throw Fault{"is cut short"};
    position_ += static_cast<std::uint64_t>(bytes);
    std::uint32_t number = 0;
    for (int n = 0; n < bytes; ++n) {
      const int shift = 8 * (encoding.big_endian ? bytes - 1 - n : n);
      number |= static_cast<std::uint32_t>(raw[static_cast<std::size_t>(n)]) << shift;
    }
    return number;
  }

  void check_length(const ElementStart& element, std::uint64_t end) const {
    if (element.length > end - position_) {
      throw Fault{"is cut short or damaged: an element is longer than what is left of it"};
    }
  }

  std::istream& in_;
  std::uint64_t size_;
  DicomFile& file_;
  std::uint64_t position_ = 0;
};

Encoding encoding_of(const std::string& transfer_syntax) {
  if (transfer_syntax == "1.2.840.10008.1.2") return {.implicit = true};
  if (transfer_syntax == "1.2.840.10008.1.2.2") return {.big_endian = true};
  return {};
}

bool is_deflated(const DicomFile& file) {
  return file.transfer_syntax == "1.2.840.10008.1.2.1.99";
}

// Where the elements begin, or nothing where this is not DICOM. Old files have no preamble and begin with an
// element of group 2 or 8 at once.
std::optional<std::uint64_t> start_of_elements(std::istream& in) {
  std::string head(132, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  in.clear();
  if (head.size() == 132 && head.ends_with("DICM")) return 132;
  if (head.size() >= 8 && (head[0] == 2 || head[0] == 8) && head[1] == 0 && head[3] == 0) return 0;
  return std::nullopt;
}

std::string inflate_rest(std::istream& in, std::uint64_t size) {
  std::string deflated(size, '\0');
  in.read(deflated.data(), static_cast<std::streamsize>(deflated.size()));
  const std::optional<std::string> inflated = inflate_raw(deflated, kMostInflation * deflated.size());
  if (!inflated) throw Fault{"is cut short or damaged: its deflated data do not inflate"};
  return *inflated;
}

void read_file(std::istream& in, std::uint64_t size, std::uint64_t start, DicomFile& file) {
  Parser parser(in, size, file);
  parser.seek(start);
  parser.read_meta();
  if (is_deflated(file)) {
    const std::string inflated = inflate_rest(in, size - parser.position());
    std::istringstream inner(inflated);
    Parser(inner, inflated.size(), file).read_data_set({});
    return;
  }
  Encoding encoding = encoding_of(file.transfer_syntax);
  if (file.transfer_syntax.empty() && size - parser.position() >= 8) {
    // Without a transfer syntax only the look of the first element tells.
    std::array<char, 6> first{};
    in.read(first.data(), first.size());
    parser.seek(parser.position());
    encoding.implicit = !std::isupper(static_cast<unsigned char>(first[4]));
  }
  file.big_endian = encoding.big_endian;
  parser.read_data_set(encoding);
}

std::ifstream open_file(const fs::path& path, std::uint64_t& size) {
  std::ifstream in(path, std::ios::binary);
  std::error_code error;
  size = fs::file_size(path, error);
  if (!in || error) throw InputError(path.string(), "cannot be read");
  return in;
}

}  // namespace

std::optional<DicomFile> read_dicom_elements(const fs::path& path) {
  std::uint64_t size = 0;
  std::ifstream in = open_file(path, size);
  const std::optional<std::uint64_t> start = start_of_elements(in);
  if (!start) return std::nullopt;
  DicomFile file;
  try {
    read_file(in, size, *start, file);
  } catch (const Fault& fault) {
    file.fault = fault.reason;
  }
  return file;
}

std::unique_ptr<std::istream> open_dicom_data(const fs::path& path) {
  std::uint64_t size = 0;
  auto in = std::make_unique<std::ifstream>(open_file(path, size));
  DicomFile file;
  try {
    Parser parser(*in, size, file);
    parser.seek(start_of_elements(*in).value_or(0));
    parser.read_meta();
    if (is_deflated(file))
      return std::make_unique<std::istringstream>(inflate_rest(*in, size - parser.position()));
  } catch (const Fault& fault) {
    throw InputError(path.string(), fault.reason);
  }
  in->seekg(0);
  return in;
}

}  // namespace osteomill
