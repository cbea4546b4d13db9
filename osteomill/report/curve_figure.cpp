#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "osteomill/files/temporary_folder.h"
#include "osteomill/report/run_figures.h"
#include "osteomill/report/thin_out.h"

namespace osteomill {

namespace {

// A column of panels, one a phase (milling on top), with a curve over time for each algorithm.
struct CurveColumn {
  // Of its data files.
  std::string name;
  // Of the y axis, with its unit.
  std::string label;
  std::function<double(const TickRecord&)> value;
  // gnuplot commands for its panels alone (scale, range, lines).
  std::string setup;
  // What its dashed line stands for, said above its panels; empty for none.
  std::string dashed;
};

struct Curve {
  AlgorithmId algorithm;
  std::string file;
  // The sum of all changes from sample to sample: how much of the panel the curve covers.
  double restlessness = 0;
};

std::string data_file(const CurveColumn& column, const MeasuredRun& run) {
  return fmt::format("{}-{}-{}.dat", column.name, run.segment, name_of(run.algorithm));
}

Curve write_curve(const CurveColumn& column, const MeasuredRun& run, std::size_t bins,
                  const TemporaryFolder& work) {
  const std::vector<TickRecord>& records = run.recording->records;
  std::vector<double> values;
  values.reserve(records.size());
  for (const TickRecord& record : records) values.push_back(column.value(record));
  Curve curve{run.algorithm, data_file(column, run)};
  for (std::size_t n = 1; n < values.size(); ++n) curve.restlessness += std::abs(values[n] - values[n - 1]);
  std::string data;
  for (const std::size_t n : thin_out_curve(values, bins)) {
    data += fmt::format("{:.4f} {:.5g}\n", records[n].time_s - records.front().time_s, values[n]);
  }
  write_figure_data(work / curve.file, data);
  return curve;
}

double last_time_s(const RunGroup& group) {
  double last = 0;
  for (const MeasuredRun& run : group.runs) {
    const auto& records = run.recording->records;
    last = std::max(
        last, records.back().time_s - records.front().time_s + run.recording->description.tick_period_s);
  }
  return last;
}

std::string panel_title(std::string segment) {
  if (segment.empty()) return "Whole session";
  segment[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(segment[0])));
  return segment;
}

// Drawn by hand at the figure's top: gnuplot's own is fitted to one panel, and is broken into rows where that
// is narrow.
std::string legend(const RunGroup& group, double height_px) {
  constexpr double kEntry_px = 220, kLine_px = 40, kTop_px = 26;
  const auto algorithms = group.algorithms();
  double x = 0.5 * (PanelGrid::kWidth_px - kEntry_px * static_cast<double>(algorithms.size()));
  const double y = 1 - kTop_px / height_px;
  std::string script;
  int tag = 101;
  for (const AlgorithmId& algorithm : algorithms) {
    script += fmt::format(
        "set arrow {0} from screen {1:.4f},screen {2:.4f} to screen {3:.4f},screen {2:.4f} nohead lw 4 lc "
        "rgb '{4}'\n"
        "set label {0} '{5}' at screen {6:.4f},screen {2:.4f} left noenhanced\n",
        tag++, x / PanelGrid::kWidth_px, y, (x + kLine_px) / PanelGrid::kWidth_px, algorithm.colour,
        algorithm.label, (x + kLine_px + 10) / PanelGrid::kWidth_px);
    x += kEntry_px;
  }
  return script;
}

// Across the panel; what it stands for is said above, where no curve runs.
std::string dashed_line(double y) {
  return fmt::format(
      "set arrow 1 from graph 0,first {0} to graph 1,first {0} nohead dt 2 lw 1.5 lc rgb '#555555' front", y);
}

std::string panel(const RunGroup& group, const CurveColumn& column, const std::string& segment,
                  const std::string& margins, bool lowest, std::size_t bins, const TemporaryFolder& work) {
  std::vector<Curve> curves;
  for (const AlgorithmId& algorithm : group.algorithms()) {
    if (const MeasuredRun* run = group.find(algorithm.name, segment)) {
      curves.push_back(write_curve(column, *run, bins, work));
    }
  }
  std::stable_sort(curves.begin(), curves.end(),
                   [](const Curve& a, const Curve& b) { return a.restlessness > b.restlessness; });
  std::string script =
      fmt::format("{}set title '{}' offset 0,-0.4\nset ylabel '{}'\n{}\n{}\n", margins, panel_title(segment),
                  column.label, lowest ? "set xlabel 'Time (s)'" : "unset xlabel", column.setup);
  std::string plot;
  for (const Curve& curve : curves) {
    plot += fmt::format("{}'{}' with lines lw 1.2 lc rgb '{}' notitle", plot.empty() ? "plot " : ", ",
                        curve.file, curve.algorithm.colour);
  }
  return script + plot;
}

std::string dashed_legend(const CurveColumn& column, const PanelGrid& grid, const PanelCell& cell) {
  constexpr double kTop_px = 54;
  if (column.dashed.empty()) return "";
  return fmt::format(
      "set label 1 '- - -  {}' at screen {:.4f},screen {:.4f} center noenhanced tc rgb '#444444'\n",
      column.dashed,
      (cell.left_px + 0.5 * (grid.left_px + cell.wide_px - grid.right_px)) / PanelGrid::kWidth_px,
      1 - kTop_px / grid.height_px);
}

double rate_of(const TickRecord& record) {
  return 1e6 / std::max(1000.0, record.busy_us());
}

double max_tick_us(const RunGroup& group) {
  double max = 0;
  for (const MeasuredRun& run : group.runs) {
    for (const TickRecord& record : run.recording->records) max = std::max(max, record.busy_us());
  }
  return max;
}

// Shared by the panels of a column, so that the segments can be compared.
std::string common_range(const RunGroup& group, const std::function<double(const TickRecord&)>& value) {
  double max = 0;
  for (const MeasuredRun& run : group.runs) {
    for (const TickRecord& record : run.recording->records) max = std::max(max, value(record));
  }
  return fmt::format("set yrange [0:{:.6g}]", max > 0 ? 1.06 * max : 1.0);
}

std::string figure_name(const char* stem, const RunGroup& group) {
  return fmt::format("{}_{}", stem, name_of(group.mode));
}

// Draws the columns side by side, the algorithms' names above them all. Curves are thinned out to the least
// and greatest of each pixel's worth, and the restless ones are drawn first so that they hide no other.
Figure draw_curves(const RunGroup& group, const std::string& name, const std::vector<CurveColumn>& columns,
                   const std::filesystem::path& folder) {
  const TemporaryFolder work;
  const std::vector<std::string> segments = group.segments();
  const PanelGrid grid{
      segments.size() > 1 ? 800.0 : 480.0, columns.size(), segments.size(), 92, 0, 112, 26, 8, 80};
  FigureScript script{name, static_cast<int>(PanelGrid::kWidth_px), static_cast<int>(grid.height_px), ""};
  script.body = begin_panels("") + fmt::format("set xrange [0:{:.6g}]\n", last_time_s(group));
  const std::size_t bins = 1000 / columns.size();
  script.body += legend(group, grid.height_px);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    for (std::size_t row = 0; row < segments.size(); ++row) {
      const PanelCell cell = panel_cell(grid, c, row);
      if (row == 0) script.body += dashed_legend(columns[c], grid, cell);
      script.body += panel(group, columns[c], segments[row], panel_margins(grid, cell),
                           row + 1 == segments.size(), bins, work);
      // Panels drawn later would print the legend again, on top of itself.
      script.body += "\nunset label\nunset arrow\n";
    }
    script.body += "unset logscale\nset format y\n";
  }
  script.body += "unset multiplot\n";
  return draw_figure(script, work, folder);
}

}  // namespace

Figure draw_rate_figure(const RunGroup& group, const std::filesystem::path& folder) {
  const double max = max_tick_us(group);
  const double lowest_rate_hz = 1e6 / std::max(1000.0, max);
  const CurveColumn rate{
      "rate", "Haptic rate (Hz)", rate_of,
      fmt::format("set yrange [{:.6g}:1020]\n{}", std::min(900.0, 100.0 * std::floor(lowest_rate_hz / 100.0)),
                  dashed_line(kMinRate_hz)),
      "950 Hz, the least acceptable"};
  const CurveColumn compute{"compute", "Compute time of a tick (µs)",
                            [](const TickRecord& r) { return std::max(0.1, r.busy_us()); },
                            fmt::format("set logscale y\nset yrange [*:{:.6g}]\nset format y '%g'\n{}",
                                        std::max(3000.0, 1.5 * max), dashed_line(1000)),
                            "1 ms, a tick at 1000 Hz"};
  return draw_curves(group, figure_name("fig6_rate", group), {rate, compute}, folder);
}

Figure draw_force_figure(const RunGroup& group, const std::filesystem::path& folder) {
  const auto magnitude = [](const TickRecord& r) { return r.wrench.force_N.norm(); };
  return draw_curves(group, figure_name("fig7_force", group),
                     {{"force", "Force (N)", magnitude, common_range(group, magnitude), ""}}, folder);
}

Figure draw_torque_figure(const RunGroup& group, const std::filesystem::path& folder) {
  const auto magnitude = [](const TickRecord& r) { return r.wrench.torque_Nmm.norm(); };
  return draw_curves(group, figure_name("fig8_torque", group),
                     {{"torque", "Torque (N mm)", magnitude, common_range(group, magnitude), ""}}, folder);
}

Figure draw_removed_figure(const RunGroup& group, const std::filesystem::path& folder) {
  const auto removed_mm3 = [](const TickRecord& r) { return r.removed_mm3; };
  return draw_curves(group, figure_name("removed", group),
                     {{"removed", "Bone removed (mm³)", removed_mm3, common_range(group, removed_mm3), ""}},
                     folder);
}

Figure draw_path_figure(const RunGroup& group, const std::filesystem::path& folder) {
  constexpr const char* kAxes[] = {"x", "y", "z"};
  std::vector<CurveColumn> columns;
  for (int axis = 0; axis < 3; ++axis) {
    columns.push_back({fmt::format("path_{}", kAxes[axis]), fmt::format("Burr along {} (mm)", kAxes[axis]),
                       [axis](const TickRecord& r) { return r.X_WT.position_mm[axis]; }, "set yrange [*:*]",
                       ""});
  }
  return draw_curves(group, figure_name("path", group), columns, folder);
}

}  // namespace osteomill
