#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace osteomill {

/// `text` so that a browser shows it as it is.
std::string html_escaped(std::string_view text);

std::string base64(std::string_view bytes);

/// <figure> with the picture itself in the page, not a link; `file` is an SVG or PNG. Throws InputError where
/// it cannot be read. `caption` is plain text.
std::string html_figure(const std::filesystem::path& file, const std::string& caption);

/// A table; cells are HTML. The first column's cells are headings.
struct HtmlTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  /// Cells are numbers, to be aligned on the right.
  bool numbers = false;
};
std::string html_table(const HtmlTable& table);

/// A whole page with its own style sheet, which loads nothing from anywhere.
std::string html_page(const std::string& title, const std::string& body);

}  // namespace osteomill
