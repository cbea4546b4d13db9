#include "dicom_text.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcspchrs.h>
#include <dcmtk/dcmdata/dctk.h>
#include <iconv.h>

#include "header_text.h"
#include "utf8_text.h"

namespace osteomill {

namespace {

// Character set of the bytes from 0x80 on, as named by a term of SpecificCharacterSet or an escape sequence
// (Part 3, C.12.1.1.2).
struct HighBytes {
  std::string_view term;
  std::string_view escape;
  const char* charset;
};
constexpr std::array<HighBytes, 14> kHighBytes{{{"ISO 2022 IR 13", ")I", "SHIFT_JIS"},
                                                {"ISO 2022 IR 58", "$)A", "GB2312"},
                                                {"ISO 2022 IR 149", "$)C", "EUC-KR"},
                                                {"ISO 2022 IR 100", "-A", "ISO-8859-1"},
                                                {"ISO 2022 IR 101", "-B", "ISO-8859-2"},
                                                {"ISO 2022 IR 109", "-C", "ISO-8859-3"},
                                                {"ISO 2022 IR 110", "-D", "ISO-8859-4"},
                                                {"ISO 2022 IR 126", "-F", "ISO-8859-7"},
                                                {"ISO 2022 IR 127", "-G", "ISO-8859-6"},
                                                {"ISO 2022 IR 138", "-H", "ISO-8859-8"},
                                                {"ISO 2022 IR 144", "-L", "ISO-8859-5"},
                                                {"ISO 2022 IR 148", "-M", "ISO-8859-9"},
                                                {"ISO 2022 IR 166", "-T", "TIS-620"},
                                                {"ISO 2022 IR 203", "-b", "ISO-8859-15"}}};

bool convert(const OFString& from, const OFString& text, OFString& converted) {
  DcmSpecificCharacterSet sets;
  return sets.selectCharacterSet(from, "ISO_IR 192").good() && sets.convertString(text, converted).good() &&
         is_utf8(converted.c_str());
}

std::optional<std::string> convert(const char* charset, std::string text) {
  iconv_t const to_utf8 = ::iconv_open("UTF-8", charset);
  if (to_utf8 == iconv_t(-1)) return std::nullopt;
  std::string utf8(4 * text.size() + 4, '\0');
  char* from = text.data();
  char* to = utf8.data();
  std::size_t left = text.size(), room = utf8.size();
  const bool failed = ::iconv(to_utf8, &from, &left, &to, &room) == static_cast<std::size_t>(-1);
  ::iconv_close(to_utf8);
  if (failed) return std::nullopt;
  utf8.resize(utf8.size() - room);
  return utf8;
}

// Text up to the next escape sequence, with the escape sequence before it (without ESC).
struct Piece {
  std::string_view escape;
  std::string_view text;
};
Piece piece_of(std::string_view text, bool has_escape) {
  // ISO 2022: intermediate bytes, then a final byte.
  std::size_t length = 0;
  while (has_escape && length < text.size() && text[length] >= ' ' && text[length] < '0') ++length;
  if (has_escape && length < text.size()) ++length;
  return {text.substr(0, length), text.substr(length)};
}

// Decodes texts that switch character sets by escape sequences. DCMTK fails on some of them if its conversion
// library lacks a set, as Debian's lacks the Japanese ones.
std::optional<std::string> from_iso2022(std::string_view first_set, std::string_view text) {
  std::string_view two_bytes;
  const char* high = "ASCII";
  // Offset of "IR 100" in "ISO 2022 IR 100", to match "ISO_IR 100" too.
  constexpr std::size_t kNumber = 9;
  for (const HighBytes& set : kHighBytes) {
    if (first_set.starts_with("ISO") && first_set.ends_with(set.term.substr(kNumber))) high = set.charset;
  }
  std::string utf8;
  bool has_escape = false;
  while (true) {
    const std::size_t end = std::min(text.find('\x1B'), text.size());
    const Piece piece = piece_of(text.substr(0, end), has_escape);
    if (piece.escape == "(B" || piece.escape == "(J") two_bytes = {};
    if (piece.escape == "$B" || piece.escape == "$@" || piece.escape == "$(D") two_bytes = piece.escape;
    for (const HighBytes& set : kHighBytes) {
      if (!piece.escape.empty() && piece.escape == set.escape) high = set.charset;
    }
    const auto converted =
        two_bytes.empty()
            ? convert(high, std::string(piece.text))
            : convert("ISO-2022-JP-2", '\x1B' + std::string(two_bytes) + std::string(piece.text));
    if (!converted) return std::nullopt;
    utf8 += *converted;
    if (end == text.size()) return utf8;
    text.remove_prefix(end + 1);
    has_escape = true;
  }
}

// Returns UTF-8.
std::string decoded(const std::string& text, const std::string& sets) {
  OFString converted;
  if (!sets.empty() && convert(sets.c_str(), text.c_str(), converted)) return converted.c_str();
  if (sets.find("2022") != std::string::npos) {
    if (auto by_escapes = from_iso2022(trimmed(sets.substr(0, sets.find('\\'))), text)) return *by_escapes;
  }
  return is_utf8(text) ? text : utf8_of_latin1(text);
}

}  // namespace

std::string display_text(DcmItem& data, const DcmTagKey& tag) {
  OFString text, sets;
  if (data.findAndGetOFStringArray(tag, text).bad()) return {};
  data.findAndGetOFStringArray(DCM_SpecificCharacterSet, sets);
  return trimmed(without_controls(decoded(text.c_str(), sets.c_str()), '?'));
}

}  // namespace osteomill
