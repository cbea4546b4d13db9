#include "osteomill/ct/dicom_lengths.h"

#include <array>
#include <cctype>
#include <cstdint>
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
constexpr std::uint32_t kPixelData = 0x7FE00010;
constexpr std::uint32_t kTransferSyntax = 0x00020010;
constexpr int kDeepest = 32;
// Images come down to a tenth or so; what would grow more than this is damaged or meant to fill the memory.
constexpr std::uint64_t kMostInflation = 100;

struct Fault {
  std::string reason;
};

struct Encoding {
  bool implicit = false;
  bool big_endian = false;
};

struct Element {
  std::uint32_t tag = 0;
  std::string vr;
  std::uint32_t length = 0;
};

// Part 5, 7.1.2: these have a 4-byte length in explicit encodings.
bool has_long_length(std::string_view vr) {
  constexpr std::array<std::string_view, 13> kLong{"OB", "OD", "OF", "OL", "OV", "OW", "SQ",
                                                   "SV", "UC", "UN", "UR", "UT", "UV"};
  for (const std::string_view one : kLong) {
    if (one == vr) return true;
  }
  return false;
}

class Walker {
 public:
  Walker(std::istream& in, std::uint64_t size) : in_(in), size_(size) {}

  std::uint64_t position() const { return position_; }
  bool saw_pixels() const { return saw_pixels_; }
  void seek(std::uint64_t position) {
    position_ = position;
    in_.seekg(static_cast<std::streamoff>(position));
  }

  // The meta group: always explicit little endian.
  std::string walk_meta() {
    std::string transfer_syntax;
    while (size_ - position_ >= 8) {
      const std::uint64_t start = position_;
      const Element element = read_element({}, size_);
      if (element.tag >> 16 != 2) {
        seek(start);
        break;
      }
      if (element.length > size_ - position_) throw_too_long(element);
      std::string value(element.tag == kTransferSyntax ? element.length : 0, '\0');
      if (!value.empty()) in_.read(value.data(), static_cast<std::streamsize>(value.size()));
      seek(position_ + element.length);
      while (!value.empty() && (value.back() == '\0' || value.back() == ' ')) value.pop_back();
      if (element.tag == kTransferSyntax) transfer_syntax = value;
    }
    return transfer_syntax;
  }

  // Up to `end`, or to the delimiter of an item without a length.
  void walk_elements(Encoding encoding, std::uint64_t end, bool until_delimiter, int depth) {
    if (depth > kDeepest) throw Fault{"sequences are nested too deep"};
    while (position_ < end) {
      // Some writers fill up the end of a file.
      if (end - position_ < 8 && depth == 0) return;
      const Element element = read_element(encoding, end);
      if (element.tag == kItemEnd && until_delimiter) return;
      if (element.tag == kPixelData && depth == 0) saw_pixels_ = element.length > 0;
      walk_value(element, encoding, end, depth);
    }
    if (until_delimiter) throw Fault{"is cut short in a sequence"};
  }

 private:
  void walk_value(const Element& element, Encoding encoding, std::uint64_t end, int depth) {
    if (element.length == kUndefinedLength) {
      if (element.tag == kPixelData) {
        walk_fragments(encoding, end);
        return;
      }
      // A sequence of unknown representation is implicit inside (Part 5, 6.2.2).
      if (element.vr == "UN") encoding.implicit = true;
      walk_items(encoding, end, true, depth);
      return;
    }
    if (element.length > end - position_) throw_too_long(element);
    const std::uint64_t after = position_ + element.length;
    if (element.length >= 8 && element.tag != kPixelData &&
        (element.vr == "SQ" || (element.vr.empty() && next_is_item(encoding)))) {
      walk_items(encoding, after, false, depth);
    }
    seek(after);
  }

  void walk_items(Encoding encoding, std::uint64_t end, bool until_delimiter, int depth) {
    while (position_ < end) {
      const Element item = read_tag_and_length(encoding, end);
      if (item.tag == kSequenceEnd) return;
      if (item.tag != kItem) throw Fault{"has a sequence that is not made of items"};
      if (item.length == kUndefinedLength) {
        walk_elements(encoding, end, true, depth + 1);
      } else {
        if (item.length > end - position_) throw_too_long(item);
        walk_elements(encoding, position_ + item.length, false, depth + 1);
      }
    }
    if (until_delimiter) throw Fault{"is cut short in a sequence"};
  }

  void walk_fragments(Encoding encoding, std::uint64_t end) {
    while (position_ < end) {
      const Element item = read_tag_and_length(encoding, end);
      if (item.tag == kSequenceEnd) return;
      if (item.tag != kItem) throw Fault{"has compressed pixels that are not made of fragments"};
      if (item.length > end - position_) throw Fault{"is cut short in its compressed pixels"};
      seek(position_ + item.length);
    }
    throw Fault{"is cut short in its compressed pixels"};
  }

  bool next_is_item(Encoding encoding) {
    const std::uint64_t here = position_;
    const std::uint32_t tag = read_tag(encoding);
    seek(here);
    return tag == kItem;
  }

  Element read_tag_and_length(Encoding encoding, std::uint64_t end) {
    if (end - position_ < 8) throw Fault{"is cut short"};
    Element element;
    element.tag = read_tag(encoding);
    element.length = read_number(4, encoding);
    return element;
  }

  Element read_element(Encoding encoding, std::uint64_t end) {
    if (encoding.implicit) return read_tag_and_length(encoding, end);
    if (end - position_ < 8) throw Fault{"is cut short"};
    Element element;
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

  [[noreturn]] static void throw_too_long(const Element& element) {
    throw Fault{element.tag == kPixelData ? "is cut short: it ends within its pixels"
                                          : "is cut short or damaged: an element is longer than the file"};
  }

  std::istream& in_;
  std::uint64_t size_;
  std::uint64_t position_ = 0;
  bool saw_pixels_ = false;
};

Encoding encoding_of(const std::string& transfer_syntax) {
  if (transfer_syntax == "1.2.840.10008.1.2") return {.implicit = true};
  if (transfer_syntax == "1.2.840.10008.1.2.2") return {.big_endian = true};
  return {};
}

// Where the elements begin, or nothing where this is not DICOM. Old files have no preamble and begin with an
// element of group 2 or 8 at once.
std::optional<std::uint64_t> start_of_elements(const std::array<char, 132>& head, std::uint64_t size) {
  if (size >= 132 && std::string_view(head.data() + 128, 4) == "DICM") return 132;
  if (size >= 8 && (head[0] == 2 || head[0] == 8) && head[1] == 0 && head[3] == 0) return 0;
  return std::nullopt;
}

void walk_data(Walker& walker, Encoding encoding, std::uint64_t size, DicomLengths& result) {
  try {
    walker.walk_elements(encoding, size, false, 0);
  } catch (const Fault&) {
    result.has_pixels = result.sound_before_pixels = walker.saw_pixels();
    throw;
  }
  result.has_pixels = walker.saw_pixels();
  result.sound_before_pixels = true;
}

void walk_file(std::istream& in, std::uint64_t size, std::uint64_t start, DicomLengths& result) {
  Walker walker(in, size);
  walker.seek(start);
  result.transfer_syntax = walker.walk_meta();
  if (result.transfer_syntax == "1.2.840.10008.1.2.1.99") {
    std::string deflated(size - walker.position(), '\0');
    in.read(deflated.data(), static_cast<std::streamsize>(deflated.size()));
    const std::optional<std::string> inflated =
        inflate_raw(deflated, kMostInflation * deflated.size() + (1 << 26));
    if (!inflated) throw Fault{"is cut short or damaged: its deflated data do not inflate"};
    std::istringstream inner(*inflated);
    Walker inner_walker(inner, inflated->size());
    walk_data(inner_walker, {}, inflated->size(), result);
    return;
  }
  Encoding encoding = encoding_of(result.transfer_syntax);
  if (result.transfer_syntax.empty() && size - walker.position() >= 8) {
    std::array<char, 6> first{};
    in.read(first.data(), first.size());
    walker.seek(walker.position());
    encoding.implicit = !std::isupper(static_cast<unsigned char>(first[4]));
  }
  walk_data(walker, encoding, size, result);
}

}  // namespace

DicomLengths check_dicom_lengths(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::error_code error;
  const std::uint64_t size = fs::file_size(path, error);
  if (!in || error) throw InputError(path.string(), "cannot be read");
  std::array<char, 132> head{};
  in.read(head.data(), head.size());
  in.clear();
  DicomLengths result;
  const std::optional<std::uint64_t> start = start_of_elements(head, size);
  if (!start) return result;
  result.is_dicom = true;
  try {
    walk_file(in, size, *start, result);
  } catch (const Fault& fault) {
    result.fault = fault.reason;
  }
  return result;
}

}  // namespace osteomill
