#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/base/pose.h"
#include "osteomill/base/temporary_folder.h"

namespace osteomill {

/// Files of a drawn figure (draw_figure()).
struct Figure {
  std::filesystem::path svg;
  std::filesystem::path png;
};

/// Grid for `draw_panels`: panels of the same size in rows and columns, below the figure's head. In pixels.
struct PanelGrid {
  double height_px = 0;
  std::size_t columns = 1;
  std::size_t rows = 1;
  double head_px = 0;
  /// Space to the left of all columns.
  double indent_px = 0;
  /// Space between the edges of a cell and the panel's axes.
  double left_px = 0, right_px = 0, above_px = 0, below_px = 0;
  static constexpr double kWidth_px = 1150;
};

/// A figure to be drawn as SVG and as PNG from one script (draw_figure()).
struct FigureScript {
  /// Name of its files, without extension.
  std::string name;
  double height_px;
  double width_px = PanelGrid::kWidth_px;
  /// gnuplot commands, which begin a multiplot.
  std::string body = {};
  /// The folder in which gnuplot runs.
  TemporaryFolder work = {};
  int files = 0;

  /// Writes a data file for `body` and returns its name in quotes. Throws InputError if it cannot be written
  /// completely: gnuplot would silently draw a truncated file.
  std::string data(std::string_view bytes);
};

/// Area of a panel in a PanelGrid: upper left corner, from the figure's lower left, and size.
struct PanelCell {
  double left_px, top_px, wide_px, high_px;
};
/// Returns the area of the panel in this column and row, both counted from 0.
PanelCell panel_cell(const PanelGrid& grid, std::size_t column, std::size_t row);

/// Returns the gnuplot commands that begin a multiplot and set the axes and grid lines ("y", or empty for
/// both) of all panels.
std::string begin_panels(std::string_view grid_lines);
/// Returns the gnuplot commands that position a panel's axes.
std::string panel_margins(const PanelGrid& grid, const PanelCell& cell);
/// An entry of a figure's legend, with its colour ("#rrggbb") and its width (legend_row()).
struct LegendEntry {
  std::string text;
  std::string_view colour;
  double wide_px;
};
/// Returns the gnuplot commands for a centred row of legend entries across the head of a PanelGrid.
std::string legend_row(const PanelGrid& grid, const std::vector<LegendEntry>& entries);

/// Runs gnuplot and writes NAME.svg and NAME.png into `folder`. Throws InputError if gnuplot or writing
/// fails.
Figure draw_figure(const FigureScript& script, const std::filesystem::path& folder);

/// Draws the panels of a grid: first the `common` commands, then those of each panel, row by row, from
/// `panel`; an empty result leaves the panel blank. Throws as draw_figure.
Figure draw_panels(
    const std::string& name, const PanelGrid& grid, const std::string& common,
    const std::function<std::string(std::size_t column, std::size_t row, FigureScript& script)>& panel,
    const std::filesystem::path& folder);

/// Returns the indices of the samples needed to draw a curve about `bins` pixels wide: the smallest and the
/// largest sample of each of `bins` equal parts, in order, so that every spike is kept. Returns all indices
/// if there are few samples.
std::vector<std::size_t> thin_out_curve(std::span<const double> values, std::size_t bins);

/// Returns the indices of samples that represent a cloud of unit directions: of each of `bins` equal parts
/// the first sample and the one farthest from `centre`.
std::vector<std::size_t> thin_out_cloud(std::span<const Vec3> directions, const Vec3& centre,
                                        std::size_t bins);

/// Runs `script` in a child process of `program` with the working folder `folder`. Throws InputError if
/// gnuplot is not installed, or, with its last line of output, if it fails.
void run_gnuplot(const std::filesystem::path& folder, const std::string& script,
                 const std::string& program = "gnuplot");

/// Returns `text` in quotes that gnuplot takes literally, without line breaks and other control characters.
std::string gnuplot_quoted(const std::string& text);

}  // namespace osteomill
