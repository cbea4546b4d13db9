#include "trials/passivity_section.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/parse_number.h"

#include "trials/csv_table.h"

namespace osteomill {

namespace {

using Kind = StiffnessLimit::Kind;

std::string_view name_of_kind(Kind kind) {
  switch (kind) {
    case Kind::found:
      return "found";
    case Kind::above_all:
      return "above";
    case Kind::below_all:
      return "none";
  }
  return "";
}

std::string cell(const PassivityRow& row) {
  if (row.limit.kind == Kind::below_all) return "none passive";
  return fmt::format("{}{:.3g} → {:.3g} (× {:.2f})", row.limit.kind == Kind::above_all ? "over " : "",
                     row.limit.stiffness_N_per_mm, row.limit.felt_N_per_mm,
                     row.limit.felt_N_per_mm / row.rule_N_per_mm);
}

std::vector<AlgorithmId> algorithms_of(std::span<const PassivityRow> rows) {
  std::vector<AlgorithmId> present;
  for (const PassivityRow& row : rows) present.push_back(row.algorithm);
  return sorted_unique(std::move(present));
}

// Returns a table with a row per device, in the order of the first algorithm's rows.
Table devices_table(std::span<const PassivityRow> rows) {
  const auto algorithms = algorithms_of(rows);
  Table table{{"Device: damping, delay", "2 b / (T + 2 τ)"}, {}, true};
  for (const AlgorithmId& algorithm : algorithms) table.header.emplace_back(algorithm.label);
  for (const PassivityRow& device : rows) {
    if (device.algorithm != algorithms.front()) continue;
    table.rows.push_back(
        {fmt::format("{:.3g} N s/m, {:.3g} ms", 1e3 * device.damping_Ns_per_mm, 1e3 * device.delay_s),
         fmt::format("{:.3g}", device.rule_N_per_mm)});
    for (const AlgorithmId& algorithm : algorithms) {
      const auto row = std::find_if(rows.begin(), rows.end(), [&](const PassivityRow& of) {
        return of.algorithm == algorithm && of.delay_s == device.delay_s &&
               of.damping_Ns_per_mm == device.damping_Ns_per_mm;
      });
      table.rows.back().push_back(row == rows.end() ? "–" : cell(*row));
    }
  }
  return table;
}

// "1 line-proxy 0.98 to 1.05, and passive at every stiffness on 1 of 12 devices"
std::string range_against_rule(std::span<const PassivityRow> rows, const AlgorithmId& algorithm) {
  std::vector<double> ratios;
  std::size_t none = 0, every = 0;
  for (const PassivityRow& row : rows) {
    if (row.algorithm != algorithm) continue;
    none += row.limit.kind == Kind::below_all;
    every += row.limit.kind == Kind::above_all;
    if (row.limit.kind == Kind::found) ratios.push_back(row.limit.felt_N_per_mm / row.rule_N_per_mm);
  }
  std::string text = algorithm.label;
  if (!ratios.empty()) {
    const auto [min, max] = std::minmax_element(ratios.begin(), ratios.end());
    text += fmt::format(" {:.2f} to {:.2f}", *min, *max);
  }
  const std::size_t all = none + every + ratios.size();
  for (const auto& [count, stiffness] : {std::pair(none, "no"), std::pair(every, "every")}) {
    if (count > 0)
      text += fmt::format("{} passive at {} stiffness on {} of {} devices",
                          text.size() > algorithm.label.size() ? ", and" : "", stiffness, count, all);
  }
  return text;
}

std::string in_words(std::span<const PassivityRow> rows) {
  std::string text;
  for (const AlgorithmId& algorithm : algorithms_of(rows)) {
    text += (text.empty() ? "" : "; ") + range_against_rule(rows, algorithm);
  }
  return "The stiffness felt at the limit, as a multiple of the rule: " + text + ".";
}

constexpr const char* kWhatWasDone =
    "The device alone, without a hand, is pressed on a flat wall of bone with 0.5 N along a guide, and then "
    "given a small speed. The test seeks the greatest --stiffness at which its swings die out: the wall, the "
    "device's delay and the tick together add no more energy to a swing than the device's own damping "
    "dissipates. An ideal wall of stiffness K, sampled every T = 1 ms and felt with a delay τ, should stay "
    "passive up to K = 2 b / (T + 2 τ) on a device with damping b. The stiffness felt is the slope of the "
    "force over the depth at 0.5 N; the rule applies to this, not to the setting. Bisection finds one "
    "limit; an algorithm that buzzes by itself may have others.";

constexpr const char* kColumns =
    "algorithm,device_damping_Ns_per_m,device_delay_s,limit,stiffness_N_per_mm,felt_N_per_mm,rule_N_per_mm";

constexpr const char* kCaption =
    "The stiffness felt when the wall is only just passive, against the device's damping. Triangle: passive "
    "up to the stiffest setting tried, 200 N/mm, which is felt as this. Missing point: passive at no "
    "setting. Points of different algorithms are shifted a little.";

double damping_Ns_per_m(const PassivityRow& row) {
  return 1e3 * row.damping_Ns_per_mm;
}

struct Axes {
  std::vector<double> delays_s;
  std::vector<AlgorithmId> algorithms;
  std::vector<double> dampings_Ns_per_m;
  double min_N_per_mm = 1;
  double max_N_per_mm = 1;
};

template <typename T>
void add_once(std::vector<T>& all, const T& value) {
  if (std::find(all.begin(), all.end(), value) == all.end()) all.push_back(value);
}

Axes axes_of(std::span<const PassivityRow> rows) {
  Axes axes;
  for (const PassivityRow& row : rows) {
    add_once(axes.delays_s, row.delay_s);
    add_once(axes.algorithms, row.algorithm);
    add_once(axes.dampings_Ns_per_m, damping_Ns_per_m(row));
    for (const double stiffness : {row.rule_N_per_mm, row.limit.felt_N_per_mm}) {
      if (!(stiffness > 0)) continue;
      axes.min_N_per_mm = std::min(axes.min_N_per_mm, stiffness);
      axes.max_N_per_mm = std::max(axes.max_N_per_mm, stiffness);
    }
  }
  std::sort(axes.dampings_Ns_per_m.begin(), axes.dampings_Ns_per_m.end());
  return axes;
}

// Columns: damping; felt stiffness, '?' if none was passive; the same if even the stiffest was passive, else
// '?'; damping; rule. `aside` shifts each algorithm a little, since several follow the rule.
std::string curve_data(std::span<const PassivityRow> rows, const AlgorithmId& algorithm, double aside,
                       double delay_s) {
  std::string data;
  for (const PassivityRow& row : rows) {
    if (row.algorithm != algorithm || row.delay_s != delay_s) continue;
    const std::string felt = fmt::format("{:.6g}", row.limit.felt_N_per_mm);
    data += fmt::format("{:.6g} {} {} {:.6g} {:.6g}\n", aside * damping_Ns_per_m(row),
                        row.limit.kind == StiffnessLimit::Kind::below_all ? "?" : felt,
                        row.limit.kind == StiffnessLimit::Kind::above_all ? felt : "?", damping_Ns_per_m(row),
                        row.rule_N_per_mm);
  }
  return data;
}

std::string panel(std::span<const PassivityRow> rows, std::size_t column, const Axes& axes,
                  FigureScript& figure) {
  std::string curves, rule;
  for (std::size_t n = 0; n < axes.algorithms.size(); ++n) {
    const AlgorithmId& algorithm = axes.algorithms[n];
    const double aside =
        std::pow(1.05, static_cast<double>(n) - 0.5 * static_cast<double>(axes.algorithms.size() - 1));
    const std::string file = figure.data(curve_data(rows, algorithm, aside, axes.delays_s[column]));
    // The rule is the same for every algorithm.
    rule = fmt::format(", {} using 4:5 with lines dt 2 lw 2 lc rgb '#8a8a8a' notitle", file);
    curves += fmt::format(
        "{2}{0} using 1:2 with linespoints pt 7 ps 0.9 lw 1.6 lc rgb '{1}' notitle, {0} using 1:3 with "
        "points pt 9 ps 1.9 lc rgb '{1}' notitle",
        file, algorithm.colour, curves.empty() ? "plot " : ", ");
  }
  return curves + rule + "\n";
}

std::string common(const Axes& axes, const PanelGrid& grid) {
  std::string tics;
  for (const double damping : axes.dampings_Ns_per_m)
    tics += fmt::format("{}{:.4g}", tics.empty() ? "" : ",", damping);
  std::vector<LegendEntry> names;
  for (const AlgorithmId& algorithm : axes.algorithms)
    names.push_back({fmt::format("● {}", algorithm.label), algorithm.colour, 200});
  names.push_back({"- - -  2 b / (T + 2 τ), an ideal wall", "#444444", 300});
  return begin_panels("y") +
         fmt::format(
             "set datafile missing '?'\nset logscale xy\nset xrange [{:.4g}:{:.4g}]\nset yrange "
             "[{:.4g}:{:.4g}]\nset xtics ({})\nset format y '%g'\nset ylabel 'Felt at the limit (N/mm)'\n"
             "set xlabel 'Damping of the device (N s/m)'\n",
             axes.dampings_Ns_per_m.front() / 1.3, 1.3 * axes.dampings_Ns_per_m.back(),
             std::pow(10.0, std::floor(std::log10(axes.min_N_per_mm))),
             std::pow(10.0, std::ceil(std::log10(axes.max_N_per_mm))), tics) +
         legend_row(grid, names);
}

}  // namespace

Figure draw_passivity_figure(std::span<const PassivityRow> rows, const std::filesystem::path& folder) {
  const Axes axes = axes_of(rows);
  PanelGrid grid{.columns = axes.delays_s.size(),
                 .head_px = 50,
                 .left_px = 84,
                 .right_px = 16,
                 .above_px = 44,
                 .below_px = 58};
  grid.height_px = grid.head_px + 330 * static_cast<double>(grid.rows);
  return draw_panels(
      "stability", grid, common(axes, grid),
      [&](std::size_t column, std::size_t, FigureScript& figure) {
        return fmt::format("set title 'delay {:.3g} ms' offset 0,-0.4\n", 1e3 * axes.delays_s[column]) +
               panel(rows, column, axes, figure) + "unset label\n";
      },
      folder);
}

Section passivity_section(std::span<const PassivityRow> rows, const Figure& figure) {
  return {.title = "Passivity against a flat wall",
          .paragraphs = {kWhatWasDone, in_words(rows)},
          .figures = {{figure.svg, kCaption}},
          .parts = {{.title = "Greatest passive stiffness in N/mm: setting → felt (against the rule)",
                     .tables = {devices_table(rows)}}}};
}

std::vector<PassivityRow> read_passivity_csv(const std::filesystem::path& path,
                                             const std::vector<AlgorithmId>& algorithms) {
  std::vector<PassivityRow> rows;
  for (const std::vector<std::string>& cells : read_csv_table(path, kColumns)) {
    const auto algorithm =
        std::ranges::find_if(algorithms, [&](const AlgorithmId& id) { return cells[0] == id.name; });
    if (cells.size() != 7 || algorithm == algorithms.end()) continue;
    PassivityRow& row = rows.emplace_back(PassivityRow{.algorithm = *algorithm});
    for (const Kind kind : {Kind::found, Kind::above_all, Kind::below_all})
      if (cells[3] == name_of_kind(kind)) row.limit.kind = kind;
    const auto number = [&](std::size_t n) { return parse_number<double>(cells[n]).value_or(0); };
    row.damping_Ns_per_mm = 1e-3 * number(1);
    row.delay_s = number(2);
    row.limit.stiffness_N_per_mm = number(4);
    row.limit.felt_N_per_mm = number(5);
    row.rule_N_per_mm = number(6);
  }
  return rows;
}

void write_passivity_csv(const std::filesystem::path& path, std::span<const PassivityRow> rows) {
  write_text_atomically(path, [&](std::ostream& out) {
    out << kColumns << '\n';
    for (const PassivityRow& row : rows) {
      out << fmt::format("{},{},{},{},{},{},{}\n", name_of(row.algorithm), damping_Ns_per_m(row), row.delay_s,
                         name_of_kind(row.limit.kind), row.limit.stiffness_N_per_mm, row.limit.felt_N_per_mm,
                         row.rule_N_per_mm);
    }
  });
}

}  // namespace osteomill
