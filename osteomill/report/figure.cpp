#include "osteomill/report/figure.h"

#include <fstream>

#include <fmt/format.h>

#include "osteomill/files/atomic_file.h"
#include "osteomill/files/input_error.h"
#include "osteomill/files/temporary_folder.h"
#include "osteomill/report/gnuplot.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

void move_whole(const fs::path& from, const fs::path& to) {
  write_file_atomically(to, [&](const fs::path& beside) {
    std::error_code error;
    fs::copy_file(from, beside, fs::copy_options::overwrite_existing, error);
    if (error) throw InputError(to.string(), "cannot be written: " + error.message());
  });
}

}  // namespace

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
  move_whole(work / (script.name + ".svg"), figure.svg);
  move_whole(work / (script.name + ".png"), figure.png);
  return figure;
}

void write_figure_data(const fs::path& path, std::string_view bytes) {
  std::ofstream out(path, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) throw InputError(path.string(), "cannot be written to its end (is the disk full?)");
}

}  // namespace osteomill
