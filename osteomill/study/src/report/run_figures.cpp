#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "osteomill/base/round_numbers.h"

#include "report/report_parts.h"

namespace osteomill {

namespace {

// A quantity drawn over time.
struct PlottedQuantity {
  // Label of the y axis, with its unit.
  std::string label;
  std::function<double(const TickRecord&)> value;
  // gnuplot commands for its panels (scale, range, lines); if empty, the value range of all runs.
  std::string setup;
};

struct Curve {
  AlgorithmId algorithm;
  std::string file;
  // Sum of absolute changes between samples: measures how much of the panel the curve covers.
  double restlessness = 0;
};

// Returns the time since the first counted tick, s; negative before it.
double time_s(const MeasuredRun& run, const TickRecord& record) {
  return record.time_s - run.recording->records.front().time_s - run.metrics.counted_from_s;
}

Curve write_curve(const PlottedQuantity& shown, const MeasuredRun& run, std::size_t bins,
                  FigureScript& figure) {
  const std::vector<TickRecord>& records = run.recording->records;
  std::vector<double> values;
  values.reserve(records.size());
  for (const TickRecord& record : records) values.push_back(shown.value(record));
  Curve curve{run.algorithm};
  for (std::size_t n = 1; n < values.size(); ++n) curve.restlessness += std::abs(values[n] - values[n - 1]);
  std::string data;
  for (const std::size_t n : thin_out_curve(values, bins)) {
    data += fmt::format("{:.4f} {:.7g}\n", time_s(run, records[n]), values[n]);
  }
  curve.file = figure.data(data);
  return curve;
}

std::string time_range(const std::vector<const MeasuredRun*>& runs) {
  double first = 0, last = 0;
  for (const MeasuredRun* run : runs) {
    first = std::min(first, -run->metrics.counted_from_s);
    last = std::max(last,
                    time_s(*run, run->recording->records.back()) + run->recording->description.tick_period_s);
  }
  return fmt::format(
      "set xrange [{:.6g}:{:.6g}]\nset object 1 rectangle from {:.6g},graph 0 to 0,graph 1 behind fc rgb "
      "'#ececec' fs solid noborder\n",
      first, last, first);
}

// Returns the range of the counted values, shared by the panels of a row; it begins at 0 unless the minimum
// is far above 0.
std::string value_range(const std::vector<const MeasuredRun*>& runs, const PlottedQuantity& shown) {
  double min = std::numeric_limits<double>::infinity(), max = 0;
  for (const MeasuredRun* run : runs) {
    for (const TickRecord& record : run->recording->records) {
      if (time_s(*run, record) < 0) continue;
      min = std::min(min, shown.value(record));
      max = std::max(max, shown.value(record));
    }
  }
  // Smallest fraction of the maximum that six digits resolve: gnuplot rejects an empty range.
  constexpr double kLeastShare = 1e-4;
  if (min > max) return "set yrange [0:1]";
  const double above = 0.06 * (max - (min < max / 2 ? 0 : min));
  return fmt::format("set yrange [{:.6g}:{:.6g}]", min < max / 2 ? 0 : min - above,
                     max > 0 ? max + std::max(above, kLeastShare * max) : 1.0);
}

std::string capitalised(std::string phase) {
  if (!phase.empty()) phase[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(phase[0])));
  return phase;
}

// Draws the legend by hand at the top of the figure: gnuplot's own fits one panel and wraps if that is
// narrow.
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

// Draws a line across the panel. Its label is above the panel, clear of the curves.
std::string dashed_line(double y) {
  return fmt::format(
      "set arrow 1 from graph 0,first {0} to graph 1,first {0} nohead dt 2 lw 1.5 lc rgb '#555555' front", y);
}

// Draws the most restless curves first so that they do not hide the others.
std::string curve_panel(const std::vector<const MeasuredRun*>& runs, const PlottedQuantity& shown,
                        std::size_t bins, FigureScript& figure) {
  std::vector<Curve> curves;
  for (const MeasuredRun* run : runs) curves.push_back(write_curve(shown, *run, bins, figure));
  std::stable_sort(curves.begin(), curves.end(),
                   [](const Curve& a, const Curve& b) { return a.restlessness > b.restlessness; });
  std::string plot;
  for (const Curve& curve : curves) {
    plot += fmt::format("{}{} with lines lw 1.2 lc rgb '{}' notitle", plot.empty() ? "plot " : ", ",
                        curve.file, curve.algorithm.colour);
  }
  // Otherwise, later panels would print the legend again on top of itself.
  return plot + "\nunset label\nunset arrow\nunset object\n";
}

// Bins per curve, about one per pixel; each keeps its smallest and largest sample.
constexpr std::size_t kCurveBins = 1000;

// Draws all algorithms in one panel per column, with a row for each phase.
Figure draw_together(const RunGroup& group, const std::string& name,
                     const std::vector<PlottedQuantity>& columns, const std::filesystem::path& folder) {
  const std::vector<std::string> phases = group.phases();
  const PanelGrid grid{
      phases.size() > 1 ? 760.0 : 440.0, columns.size(), phases.size(), 52, 0, 112, 26, 28, 60};
  const auto panel = [&](std::size_t column, std::size_t row, FigureScript& figure) {
    const auto runs = group.runs_of(phases[row]);
    const PlottedQuantity& shown = columns[column];
    return fmt::format("{}{}\nset title '{}' offset 0,-0.4\nset ylabel '{}'\n{}\n", time_range(runs),
                       shown.setup, capitalised(phases[row]), shown.label,
                       row + 1 == phases.size() ? "set xlabel 'Time (s)'" : "unset xlabel") +
           curve_panel(runs, shown, kCurveBins / columns.size(), figure);
  };
  return draw_panels(name, grid, begin_panels("") + legend(group, grid.height_px), panel, folder);
}

// Draws a panel for each algorithm, side by side at the same scale, with a row for each phase, because
// overlapping curves would be unreadable.
Figure draw_apart(const RunGroup& group, const std::string& name, const PlottedQuantity& shown,
                  const std::string& dashed, const std::filesystem::path& folder) {
  const std::vector<std::string> phases = group.phases();
  const std::vector<AlgorithmId> algorithms = group.algorithms();
  const PanelGrid grid{.height_px = phases.size() > 1 ? 680.0 : 400.0,
                       .columns = algorithms.size(),
                       .rows = phases.size(),
                       .head_px = dashed.empty() ? 6.0 : 34.0,
                       .indent_px = 84,
                       .left_px = 12,
                       .right_px = 12,
                       .above_px = 32,
                       .below_px = 72};
  std::string common = begin_panels("") + "set xlabel 'Time (s)'\n";
  if (!dashed.empty())
    common += fmt::format("set label 1 '- - -  {}' at screen 0.5,screen {:.4f} center tc rgb '#444444'\n",
                          dashed, 1 - 20 / grid.height_px);
  const auto panel = [&](std::size_t column, std::size_t row, FigureScript& figure) {
    const MeasuredRun* run = group.find(algorithms[column].name, phases[row]);
    if (run == nullptr) return std::string();
    const auto runs = group.runs_of(phases[row]);
    const std::string y_axis =
        column == 0 ? fmt::format("set ylabel '{}{}'\nset format y '%g'",
                                  phases[row].empty() ? "" : capitalised(phases[row]) + ":  ", shown.label)
                    : "unset ylabel\nset format y ''";
    return fmt::format("{}{}\nset title '{}' offset 0,-0.4 tc rgb '{}' noenhanced\n{}\n", time_range(runs),
                       shown.setup.empty() ? value_range(runs, shown) : shown.setup, algorithms[column].label,
                       algorithms[column].colour, y_axis) +
           curve_panel({run}, shown, kCurveBins / algorithms.size(), figure);
  };
  return draw_panels(name, grid, common, panel, folder);
}

// Points per panel; each takes about 90 bytes of an SVG.
constexpr std::size_t kCloudBins = 700;

struct Cloud {
  // Directions in the counted ticks with contact, or in all counted ticks if contact is too rare.
  std::vector<Vec3> directions;
  std::vector<double> times_s;
  Vec3 mean = Vec3::Zero();
};

Cloud cloud_of(const MeasuredRun& run) {
  Cloud cloud;
  const std::vector<TickRecord>& records = run.recording->records;
  const bool touched = !std::isnan(run.metrics.shaft.spread_deg);
  for (const TickRecord& record : records) {
    const double counted_s = time_s(run, record);
    if (counted_s < 0 || (touched && !contact_of(record).any())) continue;
    cloud.directions.push_back(shaft_direction(record.X_WT));
    cloud.times_s.push_back(counted_s);
    cloud.mean += cloud.directions.back();
  }
  cloud.mean.normalize();
  return cloud;
}

// Axes across the mean shaft: the two axes of W most nearly perpendicular to it.
struct PerpendicularAxes {
  Vec3 right, up;
  char right_name, up_name;
};

PerpendicularAxes across(const Vec3& mean) {
  int least = 0, most = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (std::abs(mean[axis]) > std::abs(mean[most])) most = axis;
  }
  least = most == 0 ? 1 : 0;
  const int other = 3 - most - least;
  const Vec3 right = (Vec3::Unit(least) - mean[least] * mean).normalized();
  Vec3 up = mean.cross(right);
  if (up[other] < 0) up = -up;
  return {right, up, "xyz"[least], "xyz"[other]};
}

// Returns the cloud's data for gnuplot, in degrees from its mean, and its largest extent.
std::pair<std::string, double> cloud_data(const Cloud& cloud, const PerpendicularAxes& axes) {
  std::string data;
  double reach_deg = 0.001;
  for (const std::size_t n : thin_out_cloud(cloud.directions, cloud.mean, kCloudBins)) {
    const Vec3& d = cloud.directions[n];
    const Vec3 aside = d - d.dot(cloud.mean) * cloud.mean;
    const double degrees = 180 / std::numbers::pi * std::atan2(aside.norm(), d.dot(cloud.mean));
    const double scale = aside.norm() > 0 ? degrees / aside.norm() : 0;
    reach_deg = std::max(reach_deg, degrees);
    data += fmt::format("{:.6f} {:.6f} {:.3f}\n", scale * aside.dot(axes.right), scale * aside.dot(axes.up),
                        cloud.times_s[n]);
  }
  return {std::move(data), reach_deg};
}

std::string degrees_text(double degrees) {
  return fmt::format("{:.{}f}", degrees, degrees < 1 ? 2 : 1);
}

// Texts must fit into two lines of a panel; the tables use the same words.
std::string words(const MeasuredRun& run) {
  const DirectionMetrics& shaft = run.metrics.shaft;
  if (!std::isnan(shaft.spread_deg))
    return fmt::format("spread {}°, at most {}°", degrees_text(shaft.spread_deg),
                       degrees_text(shaft.excursion_deg));
  std::string why = contact_words(run.metrics.contact);
  if (const std::size_t at = why.find(" for "); at != std::string::npos) why.replace(at, 1, "\\n");
  return why;
}

std::string shaft_panel(const MeasuredRun& run, const PanelGrid& grid, const PanelCell& cell,
                        FigureScript& figure) {
  const Cloud cloud = cloud_of(run);
  const PerpendicularAxes axes = across(cloud.mean);
  const auto [data, reach_deg] = cloud_data(cloud, axes);
  const double half_deg = 1.05 * reach_deg;
  return fmt::format(
      "{}set title \"{{/:Bold {}}}, {}\\n{}\" offset 0,-0.3\n"
      "set xrange [{:.6g}:{:.6g}]\nset yrange [{:.6g}:{:.6g}]\nset xtics {:.6g}\nset ytics {:.6g}\n"
      "set xlabel 'Towards {} of the scan (°)' offset 0,0.4\nset ylabel 'Towards {} of the scan (°)' offset "
      "1,0\n"
      "plot {} using 1:2:3 with points pt 7 ps 0.38 lc palette notitle\nunset colorbox\n",
      panel_margins(grid, cell), run.algorithm.label, run.phase, words(run), -half_deg, half_deg, -half_deg,
      half_deg, round_down(half_deg), round_down(half_deg), axes.right_name, axes.up_name, figure.data(data));
}

}  // namespace

Figure draw_rate_figure(const RunGroup& group, const std::filesystem::path& folder) {
  double max = 2000;
  for (const MeasuredRun& run : group.runs) max = std::max(max, run.metrics.tick_us.max);
  const PlottedQuantity compute{
      "compute time of a tick (µs)", [](const TickRecord& r) { return std::max(0.1, r.busy_us()); },
      fmt::format("set logscale y\nset yrange [1:{:.6g}]\n{}", 1.5 * max, dashed_line(1000))};
  return draw_apart(group, "fig6_rate", compute, "1 ms, a tick at 1000 Hz", folder);
}

Figure draw_force_figure(const RunGroup& group, const std::filesystem::path& folder) {
  const auto magnitude = [](const TickRecord& r) { return r.wrench.force_N.norm(); };
  return draw_apart(group, "fig7_force", {"force (N)", magnitude, ""}, "", folder);
}

Figure draw_torque_figure(const RunGroup& group, const std::filesystem::path& folder) {
  const auto magnitude = [](const TickRecord& r) { return r.wrench.torque_Nmm.norm(); };
  return draw_apart(group, "fig8_torque", {"torque (N mm)", magnitude, ""}, "", folder);
}

Figure draw_removed_figure(const RunGroup& group, const std::filesystem::path& folder) {
  // Omits runs that removed nothing, unless none did: their curves show nothing.
  RunGroup milled = group;
  std::erase_if(milled.runs, [](const MeasuredRun& run) { return run.metrics.removed_mm3 == 0; });
  if (milled.runs.empty()) milled = group;
  return draw_together(
      milled, "removed",
      {{"Bone removed (mm³)", [](const TickRecord& r) { return r.removed_mm3; }, "set yrange [0:*]"}},
      folder);
}

Figure draw_path_figure(const RunGroup& group, const std::filesystem::path& folder) {
  constexpr const char* kAxes[] = {"x", "y", "z"};
  std::vector<PlottedQuantity> columns;
  for (int axis = 0; axis < 3; ++axis) {
    columns.push_back({fmt::format("Burr along {} (mm)", kAxes[axis]),
                       [axis](const TickRecord& r) { return r.X_WT.position_mm[axis]; }, "set yrange [*:*]"});
  }
  return draw_together(group, "path", columns, folder);
}

Figure draw_shaft_figure(const RunGroup& group, const std::filesystem::path& folder) {
  const std::vector<std::string> phases = group.phases();
  std::size_t columns = 1;
  double last_s = 0;
  for (const std::string& phase : phases) columns = std::max(columns, group.runs_of(phase).size());
  for (const MeasuredRun& run : group.runs) {
    last_s = std::max(last_s, time_s(run, run.recording->records.back()));
  }
  // Panels are square; the colour bar is on the right.
  constexpr double kLeft_px = 84, kRight_px = 12, kAbove_px = 76, kBelow_px = 64, kBar_px = 128;
  const double wide_px = std::min(380.0, (PanelGrid::kWidth_px - kBar_px) / static_cast<double>(columns));
  const PanelGrid grid{.height_px = static_cast<double>(phases.size()) *
                                    (wide_px - kLeft_px - kRight_px + kAbove_px + kBelow_px),
                       .columns = columns,
                       .rows = phases.size(),
                       .left_px = kLeft_px,
                       .right_px = kRight_px,
                       .above_px = kAbove_px,
                       .below_px = kBelow_px};
  FigureScript script{"fig9_shaft", grid.height_px};
  script.body =
      begin_panels("") +
      fmt::format(
          "set palette defined (0 '#440154', 0.27 '#3b528b', 0.54 '#21918c', 0.8 '#5ec962', 1 "
          "'#c2df23')\nset cbrange [0:{:.6g}]\nset cblabel 'Time (s)'\n"
          "set colorbox vertical user origin screen {:.4f},screen 0.2 size screen {:.4f},screen 0.6\n",
          last_s, (static_cast<double>(columns) * wide_px + 36) / PanelGrid::kWidth_px,
          16 / PanelGrid::kWidth_px);
  for (std::size_t row = 0; row < phases.size(); ++row) {
    const auto runs = group.runs_of(phases[row]);
    for (std::size_t c = 0; c < runs.size(); ++c) {
      PanelCell cell = panel_cell(grid, c, row);
      cell.left_px = static_cast<double>(c) * wide_px;
      cell.wide_px = wide_px;
      script.body += shaft_panel(*runs[c], grid, cell, script);
    }
  }
  return draw_figure(script, folder);
}

}  // namespace osteomill
