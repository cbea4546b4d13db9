#include "osteomill/experiment/rates_figure.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "osteomill/files/temporary_folder.h"
#include "osteomill/report/gnuplot.h"
#include "osteomill/report/run_groups.h"

namespace osteomill {

namespace {

constexpr double kWidth_px = 1150;
constexpr double kHeight_px = 520;

std::vector<RateRow> rows_of(std::span<const RateRow> rows, const AlgorithmId& algorithm) {
  std::vector<RateRow> of;
  for (const RateRow& row : rows) {
    if (row.algorithm == algorithm) of.push_back(row);
  }
  return of;
}

// Whole decades about all rates, so that all panels share one scale.
std::string rate_range(std::span<const RateRow> rows) {
  double min = 1000, max = 1000;
  for (const RateRow& row : rows) {
    min = std::min(min, row.steps_per_s);
    max = std::max(max, row.steps_per_s);
    if (row.paper_rate_hz > 0) min = std::min(min, row.paper_rate_hz);
  }
  min = std::max(min, 1e-3);
  return fmt::format("set yrange [{:.4g}:{:.4g}]\n", std::pow(10.0, std::floor(std::log10(min) - 0.05)),
                     std::pow(10.0, std::ceil(std::log10(max) + 0.05)));
}

std::string tics(const std::vector<RateRow>& rows) {
  std::string list;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    list += fmt::format("{}{} {}", n == 0 ? "" : ", ", gnuplot_quoted(rows[n].resolution), n);
  }
  return fmt::format("set xtics noenhanced rotate by 35 right ({})\n", list);
}

std::string panel(const std::vector<RateRow>& rows, std::size_t column, std::size_t columns,
                  const TemporaryFolder& work) {
  const AlgorithmId& algorithm = rows.front().algorithm;
  const std::string file = fmt::format("rates-{}.dat", name_of(algorithm));
  std::string data;
  bool in_paper = false;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const bool known = rows[n].paper_rate_hz > 0;
    in_paper = in_paper || known;
    data += fmt::format("{} {:.6g} {}\n", n, rows[n].steps_per_s,
                        known ? fmt::format("{:.6g}", rows[n].paper_rate_hz) : "?");
  }
  write_figure_data(work / file, data);
  const double left_px = 116, right_px = 30, top_px = 84, bottom_px = 110;
  const double wide = (kWidth_px - left_px) / static_cast<double>(columns);
  const double left = left_px + static_cast<double>(column) * wide;
  std::string script = fmt::format(
      "set lmargin at screen {:.4f}\nset rmargin at screen {:.4f}\nset bmargin at screen {:.4f}\n"
      "set tmargin at screen {:.4f}\nset title '{}' offset 0,-0.4\nset xrange [-0.5:{}]\n{}{}",
      left / kWidth_px, (left + wide - right_px) / kWidth_px, bottom_px / kHeight_px, 1 - top_px / kHeight_px,
      algorithm.label, static_cast<double>(rows.size()) - 0.5, tics(rows),
      column == 0 ? "set ylabel 'Steps a second (Hz)'\n" : "unset ylabel\nset format y ''\n");
  script += fmt::format("plot 1000 with lines dt 2 lw 1.5 lc rgb '#555555' notitle, ");
  if (in_paper) {
    script +=
        fmt::format("'{}' using 1:3 with linespoints pt 6 ps 1.2 lw 1.5 lc rgb '#8a8a8a' notitle, ", file);
  }
  return script + fmt::format("'{}' using 1:2 with linespoints pt 7 ps 1.1 lw 2 lc rgb '{}' notitle\n", file,
                              algorithm.colour);
}

}  // namespace

Figure draw_rates_figure(std::span<const RateRow> rows, const std::filesystem::path& folder) {
  const TemporaryFolder work;
  std::vector<std::vector<RateRow>> panels;
  std::vector<AlgorithmId> algorithms;
  for (const RateRow& row : rows) algorithms.push_back(row.algorithm);
  for (const AlgorithmId& algorithm : each_once(std::move(algorithms))) {
    panels.push_back(rows_of(rows, algorithm));
  }
  FigureScript script{"rates", static_cast<int>(kWidth_px), static_cast<int>(kHeight_px), ""};
  script.body =
      "set multiplot\nset border 3 lc rgb '#444444'\nset tics nomirror out scale 0.6\nset datafile missing "
      "'?'\n"
      "set grid y lc rgb '#dddddd' lt 1 lw 0.7\nset logscale y\nset format y '%.0s %c'\nunset key\n" +
      rate_range(rows) +
      fmt::format(
          "set label 1 '● measured here    {{/:Normal ○}} the paper, on a Pentium 4    - - -  1000 Hz, "
          "what a haptic loop needs' at screen 0.5,screen {:.4f} center\n",
          1 - 26 / kHeight_px);
  for (std::size_t n = 0; n < panels.size(); ++n) {
    script.body += panel(panels[n], n, panels.size(), work) + "unset label 1\n";
  }
  script.body += "unset multiplot\n";
  return draw_figure(script, work, folder);
}

}  // namespace osteomill
