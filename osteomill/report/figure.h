#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "osteomill/files/temporary_folder.h"

namespace osteomill {

/// A figure to be drawn as SVG and as PNG from one description.
struct FigureScript {
  /// Of its files, without extension.
  std::string name;
  int width_px = 1150;
  int height_px = 760;
  /// gnuplot commands; the files that they name lie in the folder where it is run.
  std::string body;
};

/// A figure that was drawn.
struct Figure {
  std::filesystem::path svg;
  std::filesystem::path png;
};

/// Runs gnuplot in `work`, where the figure's data lie, and puts NAME.svg and NAME.png into `folder`, each
/// whole or not at all. Throws InputError where gnuplot or writing fails.
Figure draw_figure(const FigureScript& script, const TemporaryFolder& work,
                   const std::filesystem::path& folder);

/// Writes a file that a figure is drawn from. Throws InputError where it cannot be written to its end:
/// gnuplot would draw what there is of it.
void write_figure_data(const std::filesystem::path& path, std::string_view bytes);

}  // namespace osteomill
