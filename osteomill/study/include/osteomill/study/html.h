#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace osteomill {

/// `text` so that a browser shows it as it is.
std::string html_escaped(std::string_view text);

std::string base64(std::string_view bytes);

/// An SVG or PNG, which stands in the page itself, not as a link.
struct CaptionedFigure {
  std::filesystem::path file;
  std::string caption;
};

/// A table; cells are HTML. The first column's cells are headings.
struct HtmlTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  /// Cells are numbers, to be aligned on the right.
  bool numbers = false;
};

/// A part of a page, shown in the order of its fields; what is empty is not shown. All but the cells of
/// tables is plain text.
struct PageSection {
  std::string title;
  /// What a reader must know before believing the rest.
  std::vector<std::string> notices;
  std::vector<std::string> paragraphs;
  /// A list.
  std::vector<std::string> points;
  std::vector<CaptionedFigure> figures;
  std::vector<HtmlTable> tables;
  std::vector<std::string> commands;
  /// With titles a level lower.
  std::vector<PageSection> parts;
};

/// A section whose title is of this level (<h2>). Throws InputError where a figure cannot be read.
std::string html(const PageSection& section, int level = 2);

/// A whole page with its own style sheet, which loads nothing from anywhere. Throws as `html` does.
std::string html_page(const std::string& title, const std::vector<PageSection>& sections);

/// The text with U+FFFD for every byte that is no part of a character in UTF-8 (RFC 3629): names in scans,
/// and of files, may be of other encodings.
std::string valid_utf8(std::string_view text);

}  // namespace osteomill
