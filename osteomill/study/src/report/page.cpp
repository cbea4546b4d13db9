#include "osteomill/study/page.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/input_error.h"

namespace osteomill {

namespace {

// Returns the length in bytes of the UTF-8 character at the start of the text; 0 if it is invalid.
std::size_t length_of_first(std::string_view text) {
  const auto byte = [&](std::size_t n) -> std::uint32_t { return static_cast<unsigned char>(text[n]); };
  const std::uint32_t first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  std::uint32_t code = first & (0x7Fu >> length);
  for (std::size_t n = 1; n < length; ++n) {
    if ((byte(n) & 0xC0) != 0x80) return 0;
    code = code << 6 | (byte(n) & 0x3F);
  }
  const bool longer_than_needed = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool no_character = code > 0x10FFFF || (code >= 0xD800 && code < 0xE000);
  return longer_than_needed || no_character ? 0 : length;
}

}  // namespace

std::string valid_utf8(std::string_view text) {
  std::string valid;
  valid.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = length_of_first(text);
    valid += length == 0 ? "\xEF\xBF\xBD" : text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return valid;
}

namespace {

constexpr const char* kStyle = R"(
body { font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; color: #1b1b1b; background: #fff;
       max-width: 1200px; margin: 2em auto; padding: 0 1.2em; }
h1 { font-size: 1.7em; line-height: 1.2; } h2 { font-size: 1.3em; margin-top: 2em; border-bottom: 1px solid #ccc; }
h3 { font-size: 1.08em; margin-top: 1.6em; }
.wide { overflow-x: auto; max-width: 100%; background:
        linear-gradient(90deg, #fff 50%, transparent) left / 3em 100% local no-repeat,
        linear-gradient(270deg, #fff 50%, transparent) right / 3em 100% local no-repeat,
        linear-gradient(90deg, #bbb, transparent) left / 0.8em 100% no-repeat,
        linear-gradient(270deg, #bbb, transparent) right / 0.8em 100% no-repeat; }
table { border-collapse: collapse; margin: 0.8em 0; font-size: 14px; }
th, td { padding: 0.3em 0.7em; border-bottom: 1px solid #ddd; text-align: left; vertical-align: top; }
thead th { border-bottom: 2px solid #888; } tbody th { font-weight: normal; }
.numbers td, .numbers thead th + th { text-align: right; font-variant-numeric: tabular-nums; }
.numbers td { white-space: nowrap; } .numbers tbody th { min-width: 9em; }
.words { white-space: normal; display: inline-block; min-width: 8em; text-align: left; }
.strong { font-weight: 600; }
.agrees { color: #146c2e; font-weight: 600; white-space: nowrap; }
.differs { color: #a4101f; font-weight: 600; white-space: nowrap; }
.faint { color: #666; white-space: nowrap; }
@media (max-width: 700px) { table { font-size: 12px; } th, td { padding: 0.3em 0.5em; }
  .numbers tbody th { min-width: 6em; } }
.notice { background: #fff4d6; border-left: 4px solid #d9a400; padding: 0.5em 1em; }
figure { margin: 1.2em 0 2em; } figure img { max-width: 100%; height: auto; border: 1px solid #e3e3e3; }
figcaption { font-size: 14px; color: #444; margin-top: 0.3em; max-width: 60em; }
pre { background: #f4f4f4; padding: 0.8em 1em; overflow-x: auto; }
)";

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file.string(), "cannot be read");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::string html(const Cell& cell) {
  constexpr const char* kClasses[] = {"", "strong", "agrees", "differs", "faint", "words"};
  std::string html;
  for (const Cell::Piece& piece : cell.pieces) {
    std::string text = html_escaped(piece.text);
    for (auto at = text.find('\n'); at != std::string::npos; at = text.find('\n', at))
      text.replace(at, 1, "<br>");
    if (!piece.colour.empty()) text = fmt::format("<span style=\"color:{}\">{}</span>", piece.colour, text);
    if (piece.look != CellStyle::plain)
      text = fmt::format("<span class=\"{}\">{}</span>", kClasses[static_cast<int>(piece.look)], text);
    html += text;
  }
  return html;
}

std::string table_row(const std::vector<Cell>& cells, bool header) {
  std::string row = "<tr>";
  for (std::size_t n = 0; n < cells.size(); ++n) {
    const char* tag = header || n == 0 ? "th" : "td";
    row += fmt::format("<{0}>{1}</{0}>", tag, html(cells[n]));
  }
  return row + "</tr>\n";
}

// Escapes text for a quoted URL. Takes a fifth less space than base 64.
std::string in_url(std::string_view text) {
  std::string url;
  for (const char c : text) {
    const bool is_plain = c >= ' ' && c != '%' && c != '#' && c != '"' && c != '&' && c != 0x7F;
    url += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return url;
}

// Embeds the figure as an image, not as inline SVG: the figures use the same ids.
std::string html_figure(const CaptionedFigure& figure) {
  const std::string bytes = bytes_of(figure.file);
  return fmt::format(
      "<figure><img alt=\"{0}\" src=\"data:image/{1}\"><figcaption>{0}</figcaption></figure>\n",
      html_escaped(figure.caption),
      figure.file.extension() == ".svg" ? "svg+xml," + in_url(bytes) : "png;base64," + base64(bytes));
}

std::string html(const Table& table) {
  std::string html = table.numbers ? "<div class=\"wide numbers\">" : "<div class=\"wide\">";
  html += "<table>\n<thead>" + table_row({table.header.begin(), table.header.end()}, true) +
          "</thead>\n<tbody>\n";
  for (const auto& row : table.rows) html += table_row(row, false);
  return html + "</tbody></table></div>\n";
}

std::string in_tag(std::string_view tag, const std::string& text) {
  return fmt::format("<{}>{}</{}>\n", tag, html_escaped(text), tag.substr(0, tag.find(' ')));
}

}  // namespace

std::string html_escaped(std::string_view text) {
  constexpr std::pair<char, const char*> kEntities[] = {
      {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}};
  std::string escaped;
  for (const char c : text) {
    const auto* const entity = std::ranges::find(kEntities, c, &std::pair<char, const char*>::first);
    escaped += entity != std::end(kEntities) ? entity->second : std::string(1, c);
  }
  return escaped;
}

std::string base64(std::string_view bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t n = 0; n < bytes.size(); n += 3) {
    const auto byte = [&](std::size_t at) -> unsigned {
      return at < bytes.size() ? static_cast<unsigned char>(bytes[at]) : 0u;
    };
    const unsigned bits = (byte(n) << 16) | (byte(n + 1) << 8) | byte(n + 2);
    text += kDigits[bits >> 18];
    text += kDigits[(bits >> 12) & 63];
    text += n + 1 < bytes.size() ? kDigits[(bits >> 6) & 63] : '=';
    text += n + 2 < bytes.size() ? kDigits[bits & 63] : '=';
  }
  return text;
}

std::string html(const Section& section, int level) {
  std::string text;
  if (!section.id.empty()) text += fmt::format("<div id=\"{}\">\n", html_escaped(section.id));
  if (!section.title.empty()) text += fmt::format("<h{0}>{1}</h{0}>\n", level, html_escaped(section.title));
  for (const std::string& notice : section.notices) text += in_tag("p class=\"notice\"", notice);
  for (const std::string& paragraph : section.paragraphs) text += in_tag("p", paragraph);
  for (const CaptionedFigure& figure : section.figures) text += html_figure(figure);
  for (const Table& table : section.tables) text += html(table);
  if (!section.commands.empty())
    text +=
        fmt::format("<pre>{}\n</pre>\n", html_escaped(fmt::format("{}", fmt::join(section.commands, "\n"))));
  for (const Section& part : section.parts) text += html(part, level + 1);
  if (!section.id.empty()) text += "</div>\n";
  return text;
}

std::string html(const Page& page) {
  std::string body;
  for (const Section& section : page.sections) body += html(section);
  if (!page.data.empty()) {
    // In JSON, "<" occurs only in strings; unescaped, one could close the element.
    body += "<script type=\"application/json\" id=\"page-data\">";
    for (const char c : page.data) body += c == '<' ? "\\u003c" : std::string(1, c);
    body += "</script>\n";
  }
  for (const std::string_view script : page.scripts) body += fmt::format("<script>{}</script>\n", script);
  return valid_utf8(fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{0}</title>\n"
      "<style>{1}{3}</style></head>\n<body>\n<h1>{0}</h1>\n{2}</body></html>\n",
      html_escaped(page.title), kStyle, body, page.style));
}

std::filesystem::path write_page(const std::filesystem::path& out_dir, const std::string& name,
                                 const std::function<Page(const std::filesystem::path&)>& make) {
  write_folder_atomically(out_dir, [&](const std::filesystem::path& beside) {
    create_folder(beside / "figures");
    const std::string page = html(make(beside));
    write_text_atomically(beside / name, [&](std::ostream& out) { out << page; });
  });
  return out_dir / name;
}

std::string Cell::text() const {
  std::string all;
  for (const Piece& piece : pieces) all += piece.text;
  return all;
}

namespace {

// Counts characters: continuation bytes have no width.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

// Returns the text's lines, wrapped at `most` characters.
std::vector<std::string> lines_of(const std::string& text, std::size_t most) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    lines.emplace_back();
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      const bool fits = width_of(lines.back()) + width_of(word) < most;
      if (!fits && !lines.back().empty()) lines.emplace_back();
      lines.back() += (lines.back().empty() ? "" : " ") + word;
    }
  }
  return lines;
}

}  // namespace

std::string plain_text(const Table& table) {
  constexpr std::size_t kWide = 150;
  std::vector<std::vector<Cell>> rows{{table.header.begin(), table.header.end()}};
  rows.insert(rows.end(), table.rows.begin(), table.rows.end());
  std::vector<std::vector<std::vector<std::string>>> lines;
  std::vector<std::size_t> widths(table.header.size());
  for (const auto& row : rows) {
    lines.emplace_back();
    for (std::size_t n = 0; n < row.size(); ++n) {
      lines.back().push_back(lines_of(row[n].text(), kWide / widths.size()));
      for (const std::string& line : lines.back().back()) widths[n] = std::max(widths[n], width_of(line));
    }
  }
  std::string text;
  for (const auto& row : lines) {
    const auto most = std::ranges::max(row, {}, &std::vector<std::string>::size).size();
    for (std::size_t at = 0; at < most; ++at) {
      std::string line;
      for (std::size_t n = 0; n < row.size(); ++n) {
        const std::string part = at < row[n].size() ? row[n][at] : "";
        line += part + std::string(widths[n] - width_of(part) + 2, ' ');
      }
      text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
  }
  return text;
}

std::string shown_time(double seconds) {
  constexpr double kMinute = 60, kHour = 3600;
  if (seconds < 2 * kMinute) return fmt::format("{:.2g} s", seconds);
  if (seconds < 2 * kHour) return fmt::format("{:.2g} min", seconds / kMinute);
  return fmt::format("{:.3g} h", seconds / kHour);
}

std::string in_words(const std::vector<std::string>& all) {
  if (all.size() < 2) return fmt::format("{}", fmt::join(all, ""));
  return fmt::format("{} and {}", fmt::join(all.begin(), all.end() - 1, ", "), all.back());
}

std::string in_two_digits(double value) {
  return std::abs(value) < 99.5 ? fmt::format("{:.2g}", value) : fmt::format("{:.0f}", value);
}

std::string shown(double value) {
  if (std::isnan(value)) return "–";
  return std::abs(value) < 1000 ? fmt::format("{:.4g}", value) : fmt::format("{:.0f}", value);
}

}  // namespace osteomill
