#include "osteomill/study/figure.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include <fmt/format.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/input_error.h"
#include "osteomill/base/run_program.h"
#include "osteomill/study/page.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr const char* kScript = "script.gp";

// Returns the last meaningful line: gnuplot ends with a mark below the part it could not parse.
std::string last_line(const std::string& text) {
  std::istringstream in(text);
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (line.find_first_not_of(" \t^") != std::string::npos) last = line;
  }
  return last;
}

void copy_to(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
  if (error) throw InputError(to.string(), "cannot be written: " + error.message());
}

void write_bytes(const fs::path& path, std::string_view bytes) {
  write_text_atomically(path, [&](std::ostream& out) { out << bytes; });
}

// Returns two indices of each bin, chosen by `pick(first, last)`.
template <typename Pick>
std::vector<std::size_t> two_of_each(std::size_t count, std::size_t bins, Pick pick) {
  std::vector<std::size_t> kept;
  if (count <= 2 * bins) {
    kept.resize(count);
    std::iota(kept.begin(), kept.end(), std::size_t{0});
    return kept;
  }
  kept.reserve(2 * bins);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const auto [a, b] = pick(bin * count / bins, (bin + 1) * count / bins);
    kept.push_back(std::min(a, b));
    if (a != b) kept.push_back(std::max(a, b));
  }
  return kept;
}

}  // namespace

void run_gnuplot(const fs::path& folder, const std::string& script, const std::string& program) {
  write_bytes(folder / kScript, valid_utf8(script));
  // gnuplot ignores write errors; the default SIGXFSZ ends it at a file size limit. -d: ignores the user's
  // own settings, which must not change the figures.
  const ProcessResult said =
      run_program({"env", "--default-signal=XFSZ", "--chdir=" + folder.string(), program, "-d", kScript});
  if (said.exit_code == ProcessResult::kNoProgram) {
    throw InputError(program,
                     "is not installed, and without it no figures can be drawn (package gnuplot-nox)");
  }
  if (said.exit_code != 0) throw InputError(program, "could not draw a figure: " + last_line(said.text));
}

std::string gnuplot_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) continue;
    quoted += c;
    if (c == '\'') quoted += c;
  }
  return quoted + "'";
}

std::string FigureScript::data(std::string_view bytes) {
  const std::string file = fmt::format("{}.dat", ++files);
  write_bytes(work / file, bytes);
  return "'" + file + "'";
}

PanelCell panel_cell(const PanelGrid& grid, std::size_t column, std::size_t row) {
  const double wide = (PanelGrid::kWidth_px - grid.indent_px) / static_cast<double>(grid.columns);
  const double high = (grid.height_px - grid.head_px) / static_cast<double>(grid.rows);
  return {grid.indent_px + static_cast<double>(column) * wide,
          grid.height_px - grid.head_px - static_cast<double>(row) * high, wide, high};
}

std::string begin_panels(std::string_view grid_lines) {
  return fmt::format(
      "set multiplot\nset border 3 lc rgb '#444444'\nset tics nomirror out scale 0.6\n"
      "set grid {} lc rgb '#dddddd' lt 1 lw 0.7\nunset key\n",
      grid_lines);
}

std::string panel_margins(const PanelGrid& grid, const PanelCell& cell) {
  return fmt::format(
      "set lmargin at screen {:.4f}\nset rmargin at screen {:.4f}\nset tmargin at screen {:.4f}\n"
      "set bmargin at screen {:.4f}\n",
      (cell.left_px + grid.left_px) / PanelGrid::kWidth_px,
      (cell.left_px + cell.wide_px - grid.right_px) / PanelGrid::kWidth_px,
      (cell.top_px - grid.above_px) / grid.height_px,
      (cell.top_px - cell.high_px + grid.below_px) / grid.height_px);
}

std::string legend_row(const PanelGrid& grid, const std::vector<LegendEntry>& entries) {
  constexpr double kTop_px = 24;
  double wide_px = 0;
  for (const LegendEntry& entry : entries) wide_px += entry.wide_px;
  double x_px = 0.5 * (PanelGrid::kWidth_px - wide_px);
  std::string script;
  int tag = 101;
  for (const LegendEntry& entry : entries) {
    script +=
        fmt::format("set label {} '{}' at screen {:.4f},screen {:.4f} left tc rgb '{}'\n", tag++, entry.text,
                    x_px / PanelGrid::kWidth_px, 1 - kTop_px / grid.height_px, entry.colour);
    x_px += entry.wide_px;
  }
  return script;
}

Figure draw_figure(const FigureScript& script, const fs::path& folder) {
  const std::string size =
      fmt::format("{:.0f},{:.0f}", std::floor(script.width_px), std::floor(script.height_px));
  run_gnuplot(script.work.path(),
              fmt::format("set encoding utf8\n"
                          "set terminal svg size {0} font 'DejaVu Sans,14.5' background 'white'\n"
                          "set output '{1}.svg'\n{2}unset multiplot\n\nunset output\nreset\n"
                          "set terminal pngcairo size {0} font 'DejaVu Sans,11.5' background 'white'\n"
                          "set output '{1}.png'\n{2}unset multiplot\n\nunset output\n",
                          size, script.name, script.body));
  const Figure figure{folder / (script.name + ".svg"), folder / (script.name + ".png")};
  copy_to(script.work / (script.name + ".svg"), figure.svg);
  copy_to(script.work / (script.name + ".png"), figure.png);
  return figure;
}

Figure draw_panels(const std::string& name, const PanelGrid& grid, const std::string& common,
                   const std::function<std::string(std::size_t, std::size_t, FigureScript&)>& panel,
                   const fs::path& folder) {
  FigureScript script{name, grid.height_px};
  script.body = common;
  for (std::size_t row = 0; row < grid.rows; ++row) {
    for (std::size_t column = 0; column < grid.columns; ++column) {
      const std::string commands = panel(column, row, script);
      if (!commands.empty()) script.body += panel_margins(grid, panel_cell(grid, column, row)) + commands;
    }
  }
  return draw_figure(script, folder);
}

std::vector<std::size_t> thin_out_curve(std::span<const double> values, std::size_t bins) {
  return two_of_each(values.size(), bins, [&](std::size_t first, std::size_t last) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = values.begin() + static_cast<std::ptrdiff_t>(last);
    const auto [min, max] = std::minmax_element(begin, end);
    return std::pair(static_cast<std::size_t>(min - values.begin()),
                     static_cast<std::size_t>(max - values.begin()));
  });
}

std::vector<std::size_t> thin_out_cloud(std::span<const Vec3> directions, const Vec3& centre,
                                        std::size_t bins) {
  return two_of_each(directions.size(), bins, [&](std::size_t first, std::size_t last) {
    std::size_t farthest = first;
    for (std::size_t n = first; n < last; ++n) {
      if ((directions[n] - centre).squaredNorm() > (directions[farthest] - centre).squaredNorm())
        farthest = n;
    }
    return std::pair(first, farthest);
  });
}

}  // namespace osteomill
