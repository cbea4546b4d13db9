#include "osteomill/experiment/study_figure.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "osteomill/experiment/paper.h"
#include "osteomill/files/temporary_folder.h"
#include "osteomill/report/run_groups.h"

namespace osteomill {

namespace {

constexpr double kWidth_px = 1150;
constexpr double kPanelHeight_px = 280;
constexpr double kTop_px = 52;
constexpr std::size_t kColumns = 4;
constexpr std::size_t kMaxPanels = 8;
// In units of the distance between two algorithms.
constexpr double kModeShift = 0.2;
constexpr double kScatter = 0.2;
constexpr double kBarHalf = 0.15;

std::vector<double> all_values(const Study& study, std::string_view phase, const Metric& metric) {
  std::vector<double> all;
  for (const Mode mode : study.modes()) {
    for (const AlgorithmId& algorithm : study.algorithms()) {
      const auto values = study.values({algorithm, mode}, phase, metric);
      all.insert(all.end(), values.begin(), values.end());
    }
  }
  return all;
}

// Whole decades where the values spread, so that at least two tics have a number.
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

// Two blocks: the dots, and the bars at the medians.
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

std::string panel(const Study& study, std::string_view phase, const Metric& metric, std::size_t number,
                  const TemporaryFolder& work) {
  std::string plot;
  for (const Mode mode : study.modes()) {
    const double shift = study.modes().size() < 2 ? 0.0 : mode == Mode::paper ? -kModeShift : kModeShift;
    int place = 0;
    for (const AlgorithmId& algorithm : study.algorithms()) {
      const std::string file = fmt::format("study-{}-{}-{}.dat", number, name_of(mode), name_of(algorithm));
      const double x = static_cast<double>(place++) + shift;
      const std::vector<double> values = study.values({algorithm, mode}, phase, metric);
      if (values.empty()) continue;
      write_figure_data(work / file, dots_and_bars(values, x));
      plot += fmt::format(
          "{0}'{1}' index 1 with lines lw 2.5 lc rgb '{2}' notitle, '{1}' index 0 with points pt {3} ps 0.8 "
          "lw "
          "1.3 lc rgb '{2}' notitle",
          plot.empty() ? "plot " : ", ", file, algorithm.colour, mode == Mode::paper ? 6 : 7);
    }
  }
  return range_for(all_values(study, phase, metric)) + plot + "\n";
}

// The title stands over the whole panel: some are wider than its axes.
std::string frame(const Metric& metric, std::size_t number, double height_px) {
  const double left_px = 76, right_px = 10, above_px = 34, below_px = 36, title_px = 16;
  const double wide = kWidth_px / kColumns;
  const double left = static_cast<double>(number % kColumns) * wide;
  const double top = height_px - kTop_px - static_cast<double>(number / kColumns) * kPanelHeight_px;
  return fmt::format(
      "set lmargin at screen {:.4f}\nset rmargin at screen {:.4f}\nset tmargin at screen {:.4f}\nset bmargin "
      "at screen {:.4f}\nset label 2 '{}' at screen {:.4f},screen {:.4f} center\n",
      (left + left_px) / kWidth_px, (left + wide - right_px) / kWidth_px, (top - above_px) / height_px,
      (top - kPanelHeight_px + below_px) / height_px, with_unit(metric.name, metric),
      (left + 0.55 * wide) / kWidth_px, (top - title_px) / height_px);
}

std::string legend(const Study& study, std::string_view phase, double height_px) {
  constexpr double kName_px = 135, kMode_px = 85, kTitle_px = 105, kDots_px = 310;
  double x_px = 0.5 * (kWidth_px - kTitle_px - kName_px * static_cast<double>(study.algorithms().size()) -
                       kMode_px * static_cast<double>(study.modes().size()) - kDots_px);
  std::string script;
  int tag = 11;
  const auto add = [&](const std::string& text, std::string_view colour, double wide_px) {
    script += fmt::format("set label {} '{}' at screen {:.4f},screen {:.4f} left tc rgb '{}'\n", tag++, text,
                          x_px / kWidth_px, 1 - 24 / height_px, colour);
    x_px += wide_px;
  };
  constexpr std::string_view kInk = "#111111";
  add(phase == kMilling ? "Milling:" : "Holding still:", kInk, kTitle_px);
  for (const AlgorithmId& algorithm : study.algorithms()) {
    add(algorithm.label, algorithm.colour, kName_px);
  }
  for (const Mode mode : study.modes()) {
    add(fmt::format("{} {}", mode == Mode::paper ? "○" : "●", name_of(mode)), kInk, kMode_px);
  }
  add("a dot for each hand, a bar at the median", kInk, kDots_px);
  return script;
}

}  // namespace

Figure draw_study_figure(const Study& study, std::string_view phase, const std::filesystem::path& folder) {
  const TemporaryFolder work;
  std::vector<Metric> metrics = study.metrics_of(phase);
  if (metrics.size() > kMaxPanels) metrics.resize(kMaxPanels);
  const std::size_t rows = (metrics.size() + kColumns - 1) / kColumns;
  const double height_px = kTop_px + static_cast<double>(std::max<std::size_t>(rows, 1)) * kPanelHeight_px;
  FigureScript script{fmt::format("study_{}", phase), static_cast<int>(kWidth_px),
                      static_cast<int>(height_px), ""};
  script.body =
      "set multiplot\nset border 3 lc rgb '#444444'\nset tics nomirror out scale 0.6\nset grid y lc rgb "
      "'#dddddd' lt 1 lw 0.7\nset format y '%g'\nunset key\n" +
      tics(study) + legend(study, phase, height_px);
  for (std::size_t n = 0; n < metrics.size(); ++n) {
    script.body +=
        frame(metrics[n], n, height_px) + panel(study, phase, metrics[n], n, work) + "unset label\n";
  }
  script.body += "unset multiplot\n";
  return draw_figure(script, work, folder);
}

}  // namespace osteomill
