#include "osteomill/study/write_rates_report.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/csv_field.h"
#include "osteomill/base/input_error.h"
#include "osteomill/base/positive.h"
#include "osteomill/haptics/sample_points.h"
#include "osteomill/study/figure.h"
#include "osteomill/study/metric_table.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

std::vector<RateRow> rows_of(std::span<const RateRow> rows, const AlgorithmId& algorithm) {
  std::vector<RateRow> of;
  for (const RateRow& row : rows) {
    if (row.algorithm == algorithm) of.push_back(row);
  }
  return of;
}

// Returns whole decades that contain all rates, so that all panels share one scale.
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

std::string panel(const std::vector<RateRow>& rows, std::size_t column, FigureScript& figure) {
  const AlgorithmId& algorithm = rows.front().algorithm;
  std::string data;
  bool in_paper = false;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const bool known = rows[n].paper_rate_hz > 0;
    in_paper = in_paper || known;
    data += fmt::format("{} {:.6g} {}\n", n, rows[n].steps_per_s,
                        known ? fmt::format("{:.6g}", rows[n].paper_rate_hz) : "?");
  }
  const std::string file = figure.data(data);
  std::string script =
      fmt::format("set title '{}' offset 0,-0.4\nset xrange [-0.5:{}]\n{}{}", algorithm.label,
                  static_cast<double>(rows.size()) - 0.5, tics(rows),
                  column == 0 ? "set ylabel 'Steps a second (Hz)'\n" : "unset ylabel\nset format y ''\n");
  script += "plot 1000 with lines dt 2 lw 1.5 lc rgb '#555555' notitle, ";
  if (in_paper) {
    script +=
        fmt::format("{} using 1:3 with linespoints pt 6 ps 1.2 lw 1.5 lc rgb '#8a8a8a' notitle, ", file);
  }
  return script + fmt::format("{} using 1:2 with linespoints pt 7 ps 1.1 lw 2 lc rgb '{}' notitle\n", file,
                              algorithm.colour);
}

// Draws the rate against the resolution, measured and from the paper, with a panel for each algorithm and a
// line at the 1000 Hz that a haptic loop needs.
Figure draw_rates_figure(std::span<const RateRow> rows, const std::filesystem::path& folder) {
  std::vector<std::vector<RateRow>> panels;
  std::vector<AlgorithmId> algorithms;
  for (const RateRow& row : rows) algorithms.push_back(row.algorithm);
  for (const AlgorithmId& algorithm : sorted_unique(std::move(algorithms))) {
    panels.push_back(rows_of(rows, algorithm));
  }
  const PanelGrid grid{.height_px = 520,
                       .columns = panels.size(),
                       .indent_px = 116,
                       .right_px = 30,
                       .above_px = 84,
                       .below_px = 110};
  const bool in_paper =
      std::any_of(rows.begin(), rows.end(), [](const RateRow& r) { return r.paper_rate_hz > 0; });
  const std::string common =
      begin_panels("y") + "set datafile missing '?'\nset logscale y\nset format y '%.0s %c'\n" +
      rate_range(rows) +
      fmt::format(
          "set label 1 '● measured here    {}- - -  1000 Hz, what a haptic loop needs' at screen "
          "0.5,screen {:.4f} center\n",
          in_paper ? "{/:Normal ○} the paper, on a Pentium 4    " : "", 1 - 26 / grid.height_px);
  return draw_panels(
      "rates", grid, common,
      [&](std::size_t column, std::size_t, FigureScript& figure) {
        return panel(panels[column], column, figure) + "unset label 1\n";
      },
      folder);
}

void require_usable(const std::vector<RateRow>& rows) {
  if (rows.empty()) throw InputError("rates", "there are no rates to report on");
  for (const RateRow& row : rows) {
    if (!is_positive(row.rate_hz) || !is_positive(row.steps_per_s) || !is_positive(row.paced_rate_hz)) {
      throw InputError("rates", fmt::format("the rate of {} at {} is not a positive number",
                                            name_of(row.algorithm), row.resolution));
    }
  }
}

// `named` returns the columns before the numbers of a row.
template <typename Row, typename Named>
void write_rows(const fs::path& path, const char* head, const std::vector<Row>& rows, const Named& named) {
  write_text_atomically(path, [&](std::ostream& out) {
    out << head << csv_names(fields_of<Row>()) << '\n';
    for (const Row& row : rows) out << named(row) << csv_values(fields_of<Row>(), row) << '\n';
  });
}

std::string ratio_text(double ratio) {
  return fmt::format("{:.{}f}", ratio, ratio < 9.95 ? 1 : 0);
}

// Compares machines by steps per second; the paper's rates are of a loop that waits for each millisecond.
std::string plain_words(const std::vector<RateRow>& rows) {
  std::vector<double> ratios;
  std::size_t fast_enough = 0, achieved = 0;
  for (const RateRow& row : rows) {
    if (row.paper_rate_hz > 0) ratios.push_back(row.steps_per_s / row.paper_rate_hz);
    if (row.rate_hz >= kMinRate_hz) ++fast_enough;
    if (row.paced_rate_hz >= kMinRate_hz) ++achieved;
  }
  std::string text = fmt::format(
      "{} of the {} resolutions hold {:.0f} Hz or more in a loop of 1000 Hz here by their CPU time, and {} "
      "achieved that by the wall clock. ",
      fast_enough, rows.size(), kMinRate_hz, achieved);
  if (ratios.empty()) return text;
  double log_sum = 0;
  for (const double ratio : ratios) log_sum += std::log(ratio);
  const auto [min, max] = std::minmax_element(ratios.begin(), ratios.end());
  return text +
         fmt::format(
             "At the paper's resolutions this machine makes {} to {} times as many steps a second as the "
             "paper's Pentium 4 of 3.3 GHz, {} times in the geometric mean. The paper's rates are those of a "
             "loop that waits for its next millisecond and does more than the step, so they cannot exceed "
             "1000 Hz; the rates compared with them here are of the step alone and have no such limit. The "
             "ratio therefore compares the machines only if the paper's rate is well below 1000 Hz, and is "
             "too large otherwise.",
             ratio_text(*min), ratio_text(*max),
             ratio_text(std::exp(log_sum / static_cast<double>(ratios.size()))));
}

constexpr std::string_view kWhatRatesMean =
    "The table has three rates. The rate achieved is what section 8.1 of the paper measures: ticks per "
    "second of wall-clock time, in a loop paced at 1000 Hz for up to 2 s from the first contact on, without "
    "real-time scheduling. It depends on this machine and its other load; the simulated hand is part of the "
    "loop. The rate by CPU time is the one that such a loop would hold by the ticks' CPU time, which other "
    "load does not lengthen: an early tick waits for its millisecond, a late one delays the next, and the "
    "whole tick counts, not the step alone. So neither exceeds 1000 Hz, and 1000 Hz means that no tick was "
    "late. Steps a second are 1,000,000 divided by the median step in microseconds: what the algorithm's "
    "step alone would allow, without other work or waiting. The figure shows these, because the other rates "
    "hardly separate fast algorithms. These and the rate by CPU time count only steps in contact. The paper "
    "does not have barrier-shell, so no rate of the paper is next to it.";

std::string least_words(const std::vector<VertexSearchRow>& rows, const std::string& part, int papers) {
  const int least = least_vertices(rows, part);
  return fmt::format("{} on the {} ({} in the paper)",
                     least > 0 ? fmt::format("{}", least) : "none of those tried", part, papers);
}

Section vertices_section(const std::vector<VertexSearchRow>& rows) {
  Table table =
      table_of(rows, {"part"}, [](const VertexSearchRow& row) { return std::vector<Cell>{row.part}; });
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const bool least = rows[n].vertices == least_vertices(rows, rows[n].part);
    table.rows[n].back() = least              ? Cell("yes, the least", CellStyle::strong)
                           : rows[n].suffices ? Cell("yes")
                                              : Cell("no");
  }
  return {
      .title = "The least number of vertices that suffices for surface-points",
      .paragraphs = {fmt::format(
          "By this search: {}, {}. The paper reports that its tests found its numbers to be needed for "
          "correct collision detection and force, but not by what measure; the measure here is our own. The "
          "algorithm itself presses a thousand sides of its sphere, or of one circle of its shaft, into a "
          "flat wall by half the radius; the bone's density is linear, so that only the number of vertices "
          "matters. A number suffices if, for every side, the force is at most {:g}° off the wall's normal, "
          "its size differs from the mean by at most {:g} of it, and a vertex touches the bone before the "
          "part is {:g} of its radius deep. The least is the number from which on all tried "
          "suffice. These tolerances are round numbers; the table shows what others would give.",
          least_words(rows, "sphere", kSphereVertices), least_words(rows, "circle", kSliceVertices),
          VertexSearchRow::kMaxDirection_deg, VertexSearchRow::kMaxSizeOff, VertexSearchRow::kMaxUnseen)},
      .tables = {table}};
}

}  // namespace

fs::path write_rates_report(const MeasuredRates& measured, const fs::path& out_dir) {
  const std::vector<RateRow>& rows = measured.rows;
  require_usable(rows);
  create_folder(out_dir);
  // Write the measurements first: they remain if no figure can be drawn.
  write_rows(out_dir / "rates.csv", "algorithm,resolution", rows,
             [](const RateRow& row) { return name_of(row.algorithm) + "," + csv_field(row.resolution); });
  if (!measured.vertices.empty())
    write_rows(out_dir / "vertices.csv", "part", measured.vertices,
               [](const VertexSearchRow& row) { return row.part; });
  return write_page(out_dir, "rates.html", [&](const fs::path& beside) {
    Page page{"Haptic rate against resolution",
              {{.paragraphs = {plain_words(rows), std::string(kWhatRatesMean)},
                .figures = {{draw_rates_figure(rows, beside / "figures").svg,
                             "Steps a second against resolution, on a logarithmic scale. The paper's section "
                             "8.1."}},
                .tables = {table_of(rows, {"algorithm", "resolution"}, [](const RateRow& row) {
                  return std::vector<Cell>{name_of(row.algorithm), row.resolution};
                })}}}};
    if (!measured.vertices.empty()) page.sections.push_back(vertices_section(measured.vertices));
    return page;
  });
}

}  // namespace osteomill
