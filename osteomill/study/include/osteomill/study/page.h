#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace osteomill {

/// The look of a piece of a cell. In a table of numbers only `words` may be broken into lines.
enum class Look : unsigned char { plain, strong, agrees, differs, faint, words };

/// A cell of a table: plain text, whose line breaks stay, in pieces that each have a look of their own.
struct Cell {
  /// Text of one look.
  struct Piece {
    std::string text;
    Look look = Look::plain;
    /// "#rrggbb"; empty for the page's own.
    std::string colour = {};
  };
  std::vector<Piece> pieces;

  Cell(std::vector<Piece> all) : pieces(std::move(all)) {}
  Cell(std::string text = {}, Look look = Look::plain) : pieces{{std::move(text), look}} {}
  Cell(const char* text) : Cell(std::string(text)) {}
  std::string text() const;
};

/// A table. The first column's cells are headings.
struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<Cell>> rows;
  /// True if cells are numbers, to be aligned on the right.
  bool numbers = false;
};

/// Returns the table for a terminal: its columns below each other.
std::string plain_text(const Table& table);

/// An SVG or PNG with its caption; it stands in the page itself, not as a link.
struct CaptionedFigure {
  std::filesystem::path file;
  std::string caption;
};

/// A part of a Page, shown in the order of its fields; what is empty is not shown. All text is plain.
struct Section {
  std::string title;
  /// The element's name for a page's scripts; none if empty.
  std::string id = {};
  /// Sentences that a reader must know before believing the rest.
  std::vector<std::string> notices;
  std::vector<std::string> paragraphs;
  std::vector<CaptionedFigure> figures;
  std::vector<Table> tables;
  std::vector<std::string> commands;
  /// With titles a level lower.
  std::vector<Section> parts;
};

/// A page of HTML (write_page()).
struct Page {
  std::string title;
  std::vector<Section> sections;
  /// The program's own rules and scripts, which are not escaped: further rules of the style sheet, and
  /// scripts that run when all the rest is there.
  std::string style = {};
  std::vector<std::string_view> scripts = {};
  /// JSON for the scripts, in the element `page-data`; it may hold any text.
  std::string data = {};
};

/// Returns a section whose title is a heading of this level, 2 for the page's own sections. Throws InputError
/// if a figure cannot be read.
std::string html(const Section& section, int level = 2);

/// Returns a whole page with its own style sheet, which loads nothing from anywhere. Throws as `html` of a
/// section does.
std::string html(const Page& page);

/// Writes a page into `out_dir` under this name, with the files and figures that `make` puts beside it: it
/// gets a folder that has a folder `figures`. All appear together or none. Returns the page's path. Throws
/// InputError if a file cannot be written, and what `make` throws.
std::filesystem::path write_page(const std::filesystem::path& out_dir, const std::string& name,
                                 const std::function<Page(const std::filesystem::path& beside)>& make);

/// Returns the text with the characters that HTML gives a meaning (& < > ") as entities.
std::string html_escaped(std::string_view text);
/// Returns the bytes in base 64 (RFC 4648).
std::string base64(std::string_view bytes);

/// Returns the text with U+FFFD for every byte that is no part of a character in UTF-8 (RFC 3629): names in
/// scans, and of files, may be of other encodings.
std::string valid_utf8(std::string_view text);

/// Returns a time as people say it: "11 s", "4.2 min", "3.1 h".
std::string shown_time(double seconds);

/// Returns "this", "this and that" or "this, that and those".
std::string in_words(const std::vector<std::string>& all);

/// Returns a number of two significant digits, or all of those before the point.
std::string in_two_digits(double value);

/// Returns a number of four significant digits, or all of its digits before the point; "–" for none.
std::string shown(double value);

}  // namespace osteomill
