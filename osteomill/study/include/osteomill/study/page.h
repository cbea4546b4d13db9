#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace osteomill {

/// Style of a piece of a cell. In a table of numbers only `words` may wrap.
enum class CellStyle : unsigned char { plain, strong, agrees, differs, faint, words };

/// A cell of a table: plain text that keeps its line breaks, in pieces of different styles.
struct Cell {
  /// Text in one style.
  struct Piece {
    std::string text;
    CellStyle look = CellStyle::plain;
    /// "#rrggbb"; empty for the page's own.
    std::string colour = {};
  };
  std::vector<Piece> pieces;

  Cell(std::vector<Piece> all) : pieces(std::move(all)) {}
  Cell(std::string text = {}, CellStyle look = CellStyle::plain) : pieces{{std::move(text), look}} {}
  Cell(const char* text) : Cell(std::string(text)) {}
  std::string text() const;
};

/// A table. The cells of the first column are headings.
struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<Cell>> rows;
  /// True if cells are numbers, which are right-aligned.
  bool numbers = false;
};

/// Returns the table for a terminal, with aligned columns.
std::string plain_text(const Table& table);

/// An SVG or PNG with its caption, embedded in the page.
struct CaptionedFigure {
  std::filesystem::path file;
  std::string caption;
};

/// A part of a Page, shown in the order of its fields; empty fields are omitted. All text is plain.
struct Section {
  std::string title;
  /// Id of the element for a page's scripts; empty for none.
  std::string id = {};
  /// Warnings that a reader must see before the rest.
  std::vector<std::string> notices;
  std::vector<std::string> paragraphs;
  std::vector<CaptionedFigure> figures;
  std::vector<Table> tables;
  std::vector<std::string> commands;
  /// Subsections, with headings one level lower.
  std::vector<Section> parts;
};

/// A page of HTML (write_page()).
struct Page {
  std::string title;
  std::vector<Section> sections;
  /// Style rules and scripts of the program, not escaped: additions to the style sheet, and scripts that run
  /// after the page has loaded.
  std::string style = {};
  std::vector<std::string_view> scripts = {};
  /// JSON for the scripts, in the element `page-data`; may contain any text.
  std::string data = {};
};

/// Returns a section whose title is a heading of this level; 2 for the page's own sections. Throws InputError
/// if a figure cannot be read.
std::string html(const Section& section, int level = 2);

/// Returns a complete page with its own style sheet, which loads no external resources. Throws InputError if
/// a figure cannot be read.
std::string html(const Page& page);

/// Writes a page into `out_dir` under this name, with the files and figures that `make` creates: it receives
/// a folder that contains a folder `figures`. All files appear together or not at all. Returns the page's
/// path. Throws InputError if a file cannot be written, and whatever `make` throws.
std::filesystem::path write_page(const std::filesystem::path& out_dir, const std::string& name,
                                 const std::function<Page(const std::filesystem::path& beside)>& make);

/// Replaces the special characters of HTML (& < > ") by entities.
std::string html_escaped(std::string_view text);
/// Encodes bytes in base 64 (RFC 4648).
std::string base64(std::string_view bytes);

/// Replaces every byte that is not part of a valid UTF-8 character (RFC 3629) by U+FFFD: names in scans and
/// of files may have other encodings.
std::string valid_utf8(std::string_view text);

/// Returns a duration for people: "11 s", "4.2 min", "3.1 h".
std::string shown_time(double seconds);

/// Returns "this", "this and that" or "this, that and those".
std::string in_words(const std::vector<std::string>& all);

/// Returns a number with two significant digits, or all digits before the decimal point if there are more.
std::string in_two_digits(double value);

/// Returns a number with four significant digits, or all digits before the decimal point if there are more;
/// "–" for NaN.
std::string shown(double value);

}  // namespace osteomill
