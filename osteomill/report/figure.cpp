#include "osteomill/report/figure.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <numeric>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "osteomill/files/atomic_file.h"
#include "osteomill/files/input_error.h"
#include "osteomill/report/html.h"

extern char** environ;

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr const char* kScript = "script.gp";
constexpr const char* kLog = "gnuplot.log";

std::string last_line(const fs::path& path) {
  std::ifstream in(path);
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (line.find_first_not_of(" \t^") != std::string::npos) last = line;
  }
  return last;
}

// What the child does before it becomes gnuplot: its folder, no input, and all it says into a file.
class ChildSetup {
 public:
  explicit ChildSetup(const fs::path& folder) {
    ::posix_spawn_file_actions_init(&actions_);
    ::posix_spawn_file_actions_addchdir_np(&actions_, folder.c_str());
    ::posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, kLog, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO);
    // gnuplot does not look at what could not be written; a limit to its files ends it.
    ::posix_spawnattr_init(&attributes_);
    ::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGDEF);
    sigset_t signals;
    ::sigemptyset(&signals);
    ::sigaddset(&signals, SIGXFSZ);
    ::posix_spawnattr_setsigdefault(&attributes_, &signals);
  }
  ~ChildSetup() {
    ::posix_spawn_file_actions_destroy(&actions_);
    ::posix_spawnattr_destroy(&attributes_);
  }
  ChildSetup(const ChildSetup&) = delete;
  ChildSetup& operator=(const ChildSetup&) = delete;
  const posix_spawn_file_actions_t* actions() const { return &actions_; }
  const posix_spawnattr_t* attributes() const { return &attributes_; }

 private:
  posix_spawnattr_t attributes_;
  posix_spawn_file_actions_t actions_;
};

void copy_to(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
  if (error) throw InputError(to.string(), "cannot be written: " + error.message());
}

// Two indices of each bin, as `pick(first, last)` chooses them.
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

int wait_for(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return -1;
  }
  return status;
}

}  // namespace

void run_gnuplot(const fs::path& folder, const std::string& script, const std::string& program) {
  write_figure_data(folder / kScript, valid_utf8(script));
  const ChildSetup setup(folder);
  // -d: the settings of the user's own must not change the figures.
  std::string name = program, defaults = "-d", file = kScript;
  char* const arguments[] = {name.data(), defaults.data(), file.data(), nullptr};
  pid_t child = 0;
  const int failed =
      ::posix_spawnp(&child, program.c_str(), setup.actions(), setup.attributes(), arguments, environ);
  if (failed == ENOENT) {
    throw InputError(program,
                     "is not installed, and without it no figures can be drawn (package gnuplot-nox)");
  }
  if (failed != 0) throw InputError(program, std::string("cannot be started: ") + std::strerror(failed));
  const int status = wait_for(child);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw InputError(program, "could not draw a figure: " + last_line(folder / kLog));
  }
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

void write_figure_data(const fs::path& path, std::string_view bytes) {
  write_text_atomically(path, [&](std::ostream& out) { out << bytes; });
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
