#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "osteomill/files/temporary_folder.h"
#include "osteomill/report/run_figures.h"
#include "osteomill/report/thin_out.h"

namespace osteomill {

namespace {

// Points a panel; an SVG takes about 90 bytes for each.
constexpr std::size_t kBins = 700;

std::vector<Vec3> directions_of(const MeasuredRun& run) {
  std::vector<Vec3> directions;
  for (const TickRecord& record : run.recording->records) directions.push_back(shaft_direction(record.X_WT));
  return directions;
}

std::vector<const MeasuredRun*> runs_of(const RunGroup& group, const std::string& segment) {
  std::vector<const MeasuredRun*> runs;
  for (const MeasuredRun& run : group.runs) {
    if (run.segment == segment) runs.push_back(&run);
  }
  return runs;
}

// A cube about all directions of a segment.
struct Cube {
  Vec3 centre = Vec3::Zero();
  double half = 0;
};

Cube cube_about(const std::vector<const MeasuredRun*>& runs) {
  Vec3 min = Vec3::Constant(2);
  Vec3 max = Vec3::Constant(-2);
  for (const MeasuredRun* run : runs) {
    for (const Vec3& direction : directions_of(*run)) {
      min = min.cwiseMin(direction);
      max = max.cwiseMax(direction);
    }
  }
  return {0.5 * (min + max), std::max(1e-4, 0.54 * (max - min).maxCoeff())};
}

// About two steps to an axis, of 1, 2 or 5 times a power of ten.
double tic_step(double half) {
  const double power = std::pow(10.0, std::floor(std::log10(half)));
  const double ratio = half / power;
  return power * (ratio < 2 ? 1 : ratio < 5 ? 2 : 5);
}

std::string axes(const Cube& cube) {
  const double step = tic_step(cube.half);
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  std::string script;
  for (int axis = 0; axis < 3; ++axis) {
    const char name = "xyz"[axis];
    script += fmt::format(
        "set {0}range [{1:.8g}:{2:.8g}]\nset {0}tics {3:.8g} format '%.{4}f' offset {5} tc rgb '#444444'\n",
        name, cube.centre[axis] - cube.half, cube.centre[axis] + cube.half, step, decimals,
        axis == 0   ? "-0.6,-0.3"
        : axis == 1 ? "0.9,-0.3"
                    : "0.4,0");
  }
  return script;
}

void write_cloud(const MeasuredRun& run, const Vec3& centre, const std::filesystem::path& path) {
  const std::vector<TickRecord>& records = run.recording->records;
  const std::vector<Vec3> directions = directions_of(run);
  std::string data;
  for (const std::size_t n : thin_out_cloud(directions, centre, kBins)) {
    const Vec3& d = directions[n];
    data += fmt::format("{:.6f} {:.6f} {:.6f} {:.3f}\n", d.x(), d.y(), d.z(),
                        records[n].time_s - records.front().time_s);
  }
  write_figure_data(path, data);
}

struct Layout {
  double columns;
  double rows;
  double width_px;
  double height_px;
};

std::string degrees_text(double degrees) {
  return fmt::format("{:.{}f}", degrees, degrees < 1 ? 2 : 1);
}

std::string panel(const MeasuredRun& run, const Cube& cube, double column, double row, const Layout& layout,
                  const TemporaryFolder& work) {
  const std::string file = fmt::format("shaft-{}-{}.dat", run.segment, name_of(run.algorithm));
  write_cloud(run, cube.centre, work / file);
  const double bar = 105 / layout.width_px;
  const double wide = (1 - bar) / layout.columns;
  const double high = 1 / layout.rows;
  return fmt::format(
      "set origin {:.4f},{:.4f}\nset size {:.4f},{:.4f}\n"
      "set label 1 \"{{/:Bold {}}}, {}\\nspread {}°, excursion {}°\" at screen {:.4f},screen {:.4f} "
      "center\n"
      "splot '{}' using 1:2:3:4 with points pt 7 ps 0.38 lc palette notitle\n"
      "unset colorbox\n",
      column * wide + 26 / layout.width_px, 1 - (row + 1) * high, wide, high - 46 / layout.height_px,
      run.algorithm.label, run.segment, degrees_text(run.metrics.shaft.spread_deg),
      degrees_text(run.metrics.shaft.excursion_deg), (column + 0.5) * wide,
      1 - row * high - 24 / layout.height_px, file);
}

}  // namespace

Figure draw_shaft_figure(const RunGroup& group, const std::filesystem::path& folder) {
  const TemporaryFolder work;
  const std::vector<std::string> segments = group.segments();
  std::size_t columns = 1;
  double last_s = 0;
  for (const std::string& segment : segments) columns = std::max(columns, runs_of(group, segment).size());
  for (const MeasuredRun& run : group.runs) {
    last_s = std::max(last_s, run.recording->records.back().time_s - run.recording->records.front().time_s);
  }
  FigureScript script{fmt::format("fig9_shaft_{}", name_of(group.mode)),
                      static_cast<int>(385 * columns + 105), static_cast<int>(425 * segments.size()), ""};
  const Layout layout{static_cast<double>(columns), static_cast<double>(segments.size()),
                      static_cast<double>(script.width_px), static_cast<double>(script.height_px)};
  script.body = fmt::format(
      "set multiplot\nset palette defined (0 '#440154', 0.27 '#3b528b', 0.54 '#21918c', 0.8 '#5ec962', 1 "
      "'#c2df23')\nset cbrange [0:{:.6g}]\nset cblabel 'Time (s)'\nset cbtics tc rgb '#444444'\n"
      "set colorbox vertical user origin screen {:.4f},screen 0.2 size screen {:.4f},screen 0.6\n"
      "set view 58,38,1.14,1.0\nset view equal xyz\nset xyplane relative 0\nset border 4095 lc rgb '#999999' "
      "lw 0.6\n"
      "set grid x y z lc rgb '#dddddd' lt 1 lw 0.6\nset label 11 'x' at graph 0.5,-0.42,0 center\nset label "
      "12 'y' at graph 1.46,0.5,0 center\n"
      "set label 13 'z' at graph 0,0,1.09 center offset 0,0.7\n",
      last_s, 1 - 92 / layout.width_px, 16 / layout.width_px);
  for (std::size_t row = 0; row < segments.size(); ++row) {
    const auto runs = runs_of(group, segments[row]);
    const Cube cube = cube_about(runs);
    script.body += axes(cube);
    for (std::size_t c = 0; c < runs.size(); ++c) {
      script.body += panel(*runs[c], cube, static_cast<double>(c), static_cast<double>(row), layout, work);
    }
  }
  script.body += "unset multiplot\n";
  return draw_figure(script, work, folder);
}

}  // namespace osteomill
