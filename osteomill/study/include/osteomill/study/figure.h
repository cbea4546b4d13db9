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

/// The files of a figure that was drawn (draw_figure()).
struct Figure {
  std::filesystem::path svg;
  std::filesystem::path png;
};

/// The grid that `draw_panels` draws: panels of one size in rows and columns, below what stands at the
/// figure's head. In pixels.
struct PanelGrid {
  double height_px = 0;
  std::size_t columns = 1;
  std::size_t rows = 1;
  double head_px = 0;
  /// On the left of all columns.
  double indent_px = 0;
  /// From a cell's edges to the panel's axes.
  double left_px = 0, right_px = 0, above_px = 0, below_px = 0;
  static constexpr double kWidth_px = 1150;
};

/// A figure to be drawn as SVG and as PNG from one description (draw_figure()).
struct FigureScript {
  /// The name of its files, without extension.
  std::string name;
  double height_px;
  double width_px = PanelGrid::kWidth_px;
  /// gnuplot commands, which begin a multiplot.
  std::string body = {};
  /// The folder in which gnuplot runs.
  TemporaryFolder work = {};
  int files = 0;

  /// Writes a file that `body` can draw from; returns its name between quotes. Throws InputError if it
  /// cannot be written to its end: gnuplot would draw what there is of it.
  std::string data(std::string_view bytes);
};

/// One panel's room in a PanelGrid: its upper left corner, from the figure's lower left, and its size.
struct PanelCell {
  double left_px, top_px, wide_px, high_px;
};
/// Returns the room of the panel in this column and row, both counted from 0.
PanelCell panel_cell(const PanelGrid& grid, std::size_t column, std::size_t row);

/// Returns the gnuplot commands that begin a multiplot, with the axes and grid lines ("y", or empty for both)
/// of all panels.
std::string begin_panels(std::string_view grid_lines);
/// Returns the gnuplot commands that place one panel's axes.
std::string panel_margins(const PanelGrid& grid, const PanelCell& cell);
/// A name in the legend of a figure: its colour ("#rrggbb") and the width that it takes (legend_row()).
struct LegendEntry {
  std::string text;
  std::string_view colour;
  double wide_px;
};
/// Returns the gnuplot commands for a row of names across the head of a PanelGrid, as wide as the entries
/// say, in its middle.
std::string legend_row(const PanelGrid& grid, const std::vector<LegendEntry>& entries);

/// Runs gnuplot and puts NAME.svg and NAME.png into `folder`. Throws InputError if gnuplot or writing
/// fails.
Figure draw_figure(const FigureScript& script, const std::filesystem::path& folder);

/// Draws a grid's panels as draw_figure does: commands that all have in common, and then those of each, row
/// by row, from `panel`; empty for one that stays free.
Figure draw_panels(
    const std::string& name, const PanelGrid& grid, const std::string& common,
    const std::function<std::string(std::size_t column, std::size_t row, FigureScript& script)>& panel,
    const std::filesystem::path& folder);

/// Returns the indices of a curve's samples that a drawing about `bins` pixels wide needs: of each of `bins`
/// equal parts the least and the greatest sample, in order, so that no spike is lost. All indices if there
/// are few samples.
std::vector<std::size_t> thin_out_curve(std::span<const double> values, std::size_t bins);

/// Returns the indices of samples that stand for a cloud of unit directions: of each of `bins` equal parts
/// its first sample and the one farthest from `centre`.
std::vector<std::size_t> thin_out_cloud(std::span<const Vec3> directions, const Vec3& centre,
                                        std::size_t bins);

/// Runs `script` in a child process of `program` whose working folder is `folder`. Throws InputError if
/// gnuplot is not installed, or, with its own last word, if it fails.
void run_gnuplot(const std::filesystem::path& folder, const std::string& script,
                 const std::string& program = "gnuplot");

/// Returns `text` between quotes that gnuplot takes as they are, without line breaks and other control
/// characters.
std::string gnuplot_quoted(const std::string& text);

}  // namespace osteomill
