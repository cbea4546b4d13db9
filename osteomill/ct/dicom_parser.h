#pragma once

#include <cstdint>
#include <istream>
#include <string>

#include "osteomill/ct/dicom_elements.h"

namespace osteomill {

/// What a parser stops at; `reason` is the fault that goes into the DicomFile.
struct DicomFault {
  std::string reason;
};

/// How elements are written (Part 5, 7.1).
struct DicomEncoding {
  bool implicit = false;
  bool big_endian = false;
};

/// Walks over the elements of one stream and puts what is wanted of them into a DicomFile. Throws DicomFault.
class DicomParser {
 public:
  /// `size` is the length of the stream.
  DicomParser(std::istream& in, std::uint64_t size, DicomFile& file) : in_(in), size_(size), file_(file) {}

  std::uint64_t position() const { return position_; }
  void seek(std::uint64_t position);

  /// The meta group, which is always explicit little endian, from here on.
  void read_meta();
  /// The data set, from here to the end of the stream.
  void read_data_set(const DicomEncoding& encoding) { read_elements(encoding, size_, false, 0, &file_.data); }

 private:
  struct Start {
    std::uint32_t tag = 0;
    std::string vr;
    std::uint32_t length = 0;
  };

  // Up to `end`, or to the delimiter of an item without a length. No `item`: only to see where it ends.
  void read_elements(const DicomEncoding& encoding, std::uint64_t end, bool until_delimiter, int depth,
                     DicomItem* item);
  void read_element(const Start& element, DicomEncoding encoding, std::uint64_t end, int depth,
                    DicomElement* kept);
  void read_items(const DicomEncoding& encoding, std::uint64_t end, bool until_delimiter, int depth,
                  DicomElement* kept);
  void read_pixels(const Start& element, const DicomEncoding& encoding, std::uint64_t end);
  bool next_is_item(const DicomEncoding& encoding);
  std::string read_value(std::uint32_t length);
  Start read_tag_and_length(const DicomEncoding& encoding, std::uint64_t end);
  Start read_start(const DicomEncoding& encoding, std::uint64_t end);
  std::uint32_t read_tag(const DicomEncoding& encoding);
  std::uint32_t read_number(int bytes, const DicomEncoding& encoding);
  void check_length(const Start& element, std::uint64_t end) const;

  std::istream& in_;
  std::uint64_t size_;
  DicomFile& file_;
  std::uint64_t position_ = 0;
};

}  // namespace osteomill
