#include "trials/study_figure.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "osteomill/study/figure.h"
#include "osteomill/study/metric_table.h"
#include "osteomill/study/paper.h"

#include "trials/statistics.h"

namespace osteomill {

namespace {

constexpr std::size_t kColumns = 4;
constexpr std::size_t kMaxPanels = 12;
// In units of the spacing between two algorithms.
constexpr double kScatter = 0.2;
constexpr double kBarHalf = 0.15;

std::vector<double> all_values(const Study& study, std::string_view phase, const Field<RunMetrics>& metric) {
  std::vector<double> all;
  for (const AlgorithmId& algorithm : study.algorithms()) {
    const auto values = study.values(algorithm, phase, metric.get);
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

// Uses a logarithmic scale of whole decades for widely spread values, so that at least two tics have a
// number.
std::string range_for(const std::vector<double>& values) {
  if (values.empty()) return "unset logscale y\nset yrange [0:1]\n";
  const auto [min, max] = std::minmax_element(values.begin(), values.end());
  if (*min > 0 && *max > 4 * *min) {
    return fmt::format("set logscale y\nset yrange [{:.6g}:{:.6g}]\n",
                       std::pow(10.0, std::floor(std::log10(*min) + 1e-9)),
                       std::pow(10.0, std::ceil(std::log10(*max) - 1e-9)));
  }
  return fmt::format("unset logscale y\nset yrange [0:{:.6g}]\n", *max > 0 ? 1.15 * *max : 1.0);
}

// Returns two data blocks: the dots, and the bars at the medians.
std::string dots_and_bars(const std::vector<double>& values, double x) {
  std::string dots, bars;
  const double last = std::max<double>(1, static_cast<double>(values.size()) - 1);
  for (std::size_t n = 0; n < values.size(); ++n) {
    const double across = kScatter * (static_cast<double>(n) / last - 0.5);
    dots += fmt::format("{:.4f} {:.6g}\n", values.size() > 1 ? x + across : x, values[n]);
  }
  const double median = distribution_of(values).median;
  bars = fmt::format("{:.4f} {:.6g}\n{:.4f} {:.6g}\n", x - kBarHalf, median, x + kBarHalf, median);
  return dots + "\n\n" + bars;
}

std::string tics(const Study& study) {
  std::string list;
  int place = 0;
  for (const AlgorithmId& algorithm : study.algorithms()) {
    list += fmt::format("{}'{}' {}", place == 0 ? "" : ", ", short_label(algorithm), place);
    ++place;
  }
  return fmt::format("set xrange [-0.5:{}]\nset xtics scale 0 ({})\n", static_cast<double>(place) - 0.5,
                     list);
}

std::string panel(const Study& study, std::string_view phase, const Field<RunMetrics>& metric,
                  FigureScript& figure) {
  std::string plot;
  int place = 0;
  for (const AlgorithmId& algorithm : study.algorithms()) {
    const double x = place++;
    const std::vector<double> values = study.values(algorithm, phase, metric.get);
    if (values.empty()) continue;
    plot += fmt::format(
        "{0}{1} index 1 with lines lw 2.5 lc rgb '{2}' notitle, {1} index 0 with points pt 7 ps 0.8 lw 1.3 "
        "lc rgb '{2}' notitle",
        plot.empty() ? "plot " : ", ", figure.data(dots_and_bars(values, x)), algorithm.colour);
  }
  return range_for(all_values(study, phase, metric)) + plot + "\n";
}

// Breaks a text wider than a panel at the space nearest to its middle, but not between a number and its unit.
std::string in_two_lines(std::string text) {
  constexpr std::size_t kMostInALine = 26;
  if (text.size() <= kMostInALine) return text;
  std::size_t nearest = std::string::npos, least = text.size();
  for (std::size_t blank = text.find(' '); blank != std::string::npos; blank = text.find(' ', blank + 1)) {
    const std::size_t off = 2 * blank > text.size() ? 2 * blank - text.size() : text.size() - 2 * blank;
    const bool is_in_number = blank > 0 && text[blank - 1] >= '0' && text[blank - 1] <= '9';
    if (is_in_number || off >= least) continue;
    nearest = blank;
    least = off;
  }
  if (nearest != std::string::npos) text.replace(nearest, 1, "\\n");
  return text;
}

// Centres the title on the whole panel: some titles are wider than its axes.
std::string title(const Field<RunMetrics>& metric, const PanelGrid& grid, const PanelCell& cell) {
  constexpr double kTitle_px = 28;
  return fmt::format("set label 2 \"{}\" at screen {:.4f},screen {:.4f} center\n",
                     in_two_lines(label_of(metric)),
                     (cell.left_px + 0.55 * cell.wide_px) / PanelGrid::kWidth_px,
                     (cell.top_px - kTitle_px) / grid.height_px);
}

std::vector<LegendEntry> legend(const Study& study, std::string_view phase) {
  constexpr std::string_view kInk = "#111111";
  std::vector<LegendEntry> entries{{phase == kMilling ? "Milling:" : "Holding still:", kInk, 125}};
  for (const AlgorithmId& algorithm : study.algorithms())
    entries.push_back({algorithm.label, algorithm.colour, 155});
  entries.push_back({"a dot for each hand, a bar at the median", kInk, 310});
  return entries;
}

Figure draw_phase(const Study& study, std::string_view phase, const std::filesystem::path& folder) {
  std::vector<Field<RunMetrics>> metrics = study.metrics_of(phase);
  if (metrics.size() > kMaxPanels) metrics.resize(kMaxPanels);
  PanelGrid grid{.columns = kColumns,
                 .rows = std::max<std::size_t>((metrics.size() + kColumns - 1) / kColumns, 1),
                 .head_px = 52,
                 .left_px = 76,
                 .right_px = 10,
                 .above_px = 64,
                 .below_px = 36};
  grid.height_px = grid.head_px + 310 * static_cast<double>(grid.rows);
  return draw_panels(
      fmt::format("study_{}", phase), grid,
      begin_panels("y") + "set format y '%g'\n" + tics(study) + legend_row(grid, legend(study, phase)),
      [&](std::size_t column, std::size_t row, FigureScript& figure) {
        const std::size_t n = row * kColumns + column;
        if (n >= metrics.size()) return std::string();
        return title(metrics[n], grid, panel_cell(grid, column, row)) +
               panel(study, phase, metrics[n], figure) + "unset label\n";
      },
      folder);
}

}  // namespace

std::vector<CaptionedFigure> draw_hands(const Study& study, const std::filesystem::path& folder) {
  std::vector<CaptionedFigure> figures;
  for (const std::string_view phase : study.phases())
    figures.push_back({draw_phase(study, phase, folder).svg,
                       "Every hand of the study, by algorithm. Each panel has its own scale, "
                       "logarithmic if values lie far apart."});
  return figures;
}

}  // namespace osteomill
