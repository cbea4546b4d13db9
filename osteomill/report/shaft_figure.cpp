#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "osteomill/files/temporary_folder.h"
#include "osteomill/report/contact.h"
#include "osteomill/report/run_figures.h"
#include "osteomill/report/thin_out.h"

namespace osteomill {

namespace {

// Points a panel; an SVG takes about 90 bytes for each.
constexpr std::size_t kBins = 700;

struct Cloud {
  // Of the counted ticks in which the tool touched, or of all where it hardly did.
  std::vector<Vec3> directions;
  std::vector<double> times_s;
  Vec3 mean = Vec3::Zero();
};

Cloud cloud_of(const MeasuredRun& run) {
  Cloud cloud;
  const std::vector<TickRecord>& records = run.recording->records;
  const bool touched = !std::isnan(run.metrics.shaft.spread_deg);
  for (const TickRecord& record : records) {
    const double time_s = record.time_s - records.front().time_s - run.metrics.counted_from_s;
    if (time_s < 0 || (touched && !contact_of(record).any())) continue;
    cloud.directions.push_back(shaft_direction(record.X_WT));
    cloud.times_s.push_back(time_s);
    cloud.mean += cloud.directions.back();
  }
  cloud.mean.normalize();
  return cloud;
}

// Across the mean shaft: along the two axes of W to which it is nearest to a right angle.
struct Across {
  Vec3 right, up;
  char right_name, up_name;
};

Across across(const Vec3& mean) {
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

// About two steps to an axis, of 1, 2 or 5 times a power of ten.
double tic_step(double half) {
  const double power = std::pow(10.0, std::floor(std::log10(half)));
  const double ratio = half / power;
  return power * (ratio < 2 ? 1 : ratio < 5 ? 2 : 5);
}

// Writes the cloud in degrees from its mean, and returns how far it reaches.
double write_cloud(const Cloud& cloud, const Across& axes, const std::filesystem::path& path) {
  std::string data;
  double reach_deg = 0.001;
  for (const std::size_t n : thin_out_cloud(cloud.directions, cloud.mean, kBins)) {
    const Vec3& d = cloud.directions[n];
    const Vec3 aside = d - d.dot(cloud.mean) * cloud.mean;
    const double degrees = 180 / std::numbers::pi * std::atan2(aside.norm(), d.dot(cloud.mean));
    const double scale = aside.norm() > 0 ? degrees / aside.norm() : 0;
    reach_deg = std::max(reach_deg, degrees);
    data += fmt::format("{:.6f} {:.6f} {:.3f}\n", scale * aside.dot(axes.right), scale * aside.dot(axes.up),
                        cloud.times_s[n]);
  }
  write_figure_data(path, data);
  return reach_deg;
}

std::string degrees_text(double degrees) {
  return fmt::format("{:.{}f}", degrees, degrees < 1 ? 2 : 1);
}

std::string words(const MeasuredRun& run) {
  const DirectionMetrics& shaft = run.metrics.shaft;
  // The tables say for how long it did, at more length than there is room for here.
  return std::isnan(shaft.spread_deg) ? "too little contact"
                                      : fmt::format("spread {}°, at most {}°", degrees_text(shaft.spread_deg),
                                                    degrees_text(shaft.excursion_deg));
}

std::string panel(const MeasuredRun& run, const PanelGrid& grid, const PanelCell& cell,
                  const TemporaryFolder& work) {
  const std::string file = fmt::format("shaft-{}-{}.dat", run.phase, name_of(run.algorithm));
  const Cloud cloud = cloud_of(run);
  const Across axes = across(cloud.mean);
  const double half_deg = 1.05 * write_cloud(cloud, axes, work / file);
  return fmt::format(
      "{}set title \"{{/:Bold {}}}, {}\\n{}\" offset 0,-0.3\n"
      "set xrange [{:.6g}:{:.6g}]\nset yrange [{:.6g}:{:.6g}]\nset xtics {:.6g}\nset ytics {:.6g}\n"
      "set xlabel 'Towards {} (°)' offset 0,0.4\nset ylabel 'Towards {} (°)' offset 1,0\n"
      "plot '{}' using 1:2:3 with points pt 7 ps 0.38 lc palette notitle\nunset colorbox\n",
      panel_margins(grid, cell), run.algorithm.label, run.phase, words(run), -half_deg, half_deg, -half_deg,
      half_deg, tic_step(half_deg), tic_step(half_deg), axes.right_name, axes.up_name, file);
}

}  // namespace

Figure draw_shaft_figure(const RunGroup& group, const std::filesystem::path& folder) {
  const TemporaryFolder work;
  const std::vector<std::string> phases = group.phases();
  std::size_t columns = 1;
  double last_s = 0;
  for (const std::string& phase : phases) columns = std::max(columns, group.runs_of(phase).size());
  for (const MeasuredRun& run : group.runs) {
    last_s = std::max(last_s, run.recording->records.back().time_s - run.recording->records.front().time_s -
                                  run.metrics.counted_from_s);
  }
  // Square panels, and the colours' scale on the right.
  constexpr double kLeft_px = 84, kRight_px = 12, kAbove_px = 60, kBelow_px = 64, kBar_px = 128;
  const double wide_px = std::min(380.0, (PanelGrid::kWidth_px - kBar_px) / static_cast<double>(columns));
  const PanelGrid grid{.height_px = static_cast<double>(phases.size()) *
                                    (wide_px - kLeft_px - kRight_px + kAbove_px + kBelow_px),
                       .columns = columns,
                       .rows = phases.size(),
                       .left_px = kLeft_px,
                       .right_px = kRight_px,
                       .above_px = kAbove_px,
                       .below_px = kBelow_px};
  FigureScript script{fmt::format("fig9_shaft_{}", name_of(group.mode)), grid.height_px};
  script.body =
      begin_panels("") +
      fmt::format(
          "set palette defined (0 '#440154', 0.27 '#3b528b', 0.54 '#21918c', 0.8 '#5ec962', 1 "
          "'#c2df23')\nset cbrange [0:{:.6g}]\nset cblabel 'Time (s)'\n"
          "set colorbox vertical user origin screen {:.4f},screen 0.2 size screen {:.4f},screen 0.6\n",
          last_s, 1 - (kBar_px - 16) / PanelGrid::kWidth_px, 16 / PanelGrid::kWidth_px);
  for (std::size_t row = 0; row < phases.size(); ++row) {
    const auto runs = group.runs_of(phases[row]);
    for (std::size_t c = 0; c < runs.size(); ++c) {
      PanelCell cell = panel_cell(grid, c, row);
      cell.left_px = static_cast<double>(c) * wide_px;
      cell.wide_px = wide_px;
      script.body += panel(*runs[c], grid, cell, work);
    }
  }
  return draw_figure(script, work, folder);
}

}  // namespace osteomill
