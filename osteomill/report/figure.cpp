#include "osteomill/report/figure.h"

#include <fstream>

#include <fmt/format.h>

#include "osteomill/files/input_error.h"
#include "osteomill/files/temporary_folder.h"
#include "osteomill/report/gnuplot.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

void copy_to(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
  if (error) throw InputError(to.string(), "cannot be written: " + error.message());
}

}  // namespace

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

Figure draw_figure(const FigureScript& script, const TemporaryFolder& work, const fs::path& folder) {
  const std::string size = fmt::format("{},{}", script.width_px, script.height_px);
  run_gnuplot(work.path(),
              fmt::format("set encoding utf8\n"
                          "set terminal svg size {0} font 'DejaVu Sans,14.5' background 'white'\n"
                          "set output '{1}.svg'\n{2}\nunset output\nreset\n"
                          "set terminal pngcairo size {0} font 'DejaVu Sans,11.5' background 'white'\n"
                          "set output '{1}.png'\n{2}\nunset output\n",
                          size, script.name, script.body));
  const Figure figure{folder / (script.name + ".svg"), folder / (script.name + ".png")};
  copy_to(work / (script.name + ".svg"), figure.svg);
  copy_to(work / (script.name + ".png"), figure.png);
  return figure;
}

void write_figure_data(const fs::path& path, std::string_view bytes) {
  std::ofstream out(path, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) throw InputError(path.string(), "cannot be written to its end (is the disk full?)");
}

}  // namespace osteomill
