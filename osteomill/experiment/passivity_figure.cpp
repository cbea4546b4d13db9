#include "osteomill/experiment/passivity_figure.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "osteomill/files/temporary_folder.h"
#include "osteomill/report/run_groups.h"

namespace osteomill {

namespace {

constexpr double kWidth_px = 1150;
constexpr double kPanelHeight_px = 330;
constexpr double kTop_px = 50;

double damping_Ns_per_m(const PassivityRow& row) {
  return 1e3 * row.setup.damping_Ns_per_mm;
}

struct Axes {
  std::vector<Mode> modes;
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
    add_once(axes.modes, row.setup.mode);
    add_once(axes.delays_s, row.setup.delay_s);
    add_once(axes.algorithms, row.setup.algorithm.id);
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

// Damping, felt stiffness or '?' where none was passive, the same where even the stiffest was, damping, rule.
// Each algorithm a little aside, since several follow the rule.
std::string curve_data(std::span<const PassivityRow> rows, const AlgorithmId& algorithm, double aside,
                       Mode mode, double delay_s) {
  std::string data;
  for (const PassivityRow& row : rows) {
    const PassivityCase& setup = row.setup;
    if (setup.algorithm.id != algorithm || setup.mode != mode || setup.delay_s != delay_s) continue;
    const std::string felt = fmt::format("{:.6g}", row.limit.felt_N_per_mm);
    data += fmt::format("{:.6g} {} {} {:.6g} {:.6g}\n", aside * damping_Ns_per_m(row),
                        row.limit.kind == StiffnessLimit::Kind::below_all ? "?" : felt,
                        row.limit.kind == StiffnessLimit::Kind::above_all ? felt : "?", damping_Ns_per_m(row),
                        row.rule_N_per_mm);
  }
  return data;
}

std::string frame(std::size_t column, std::size_t row, const Axes& axes, double height_px) {
  const double left_px = 84, right_px = 16, above_px = 44, below_px = 58;
  const double wide = kWidth_px / static_cast<double>(axes.delays_s.size());
  const double left = static_cast<double>(column) * wide;
  const double top = height_px - kTop_px - static_cast<double>(row) * kPanelHeight_px;
  return fmt::format(
      "set lmargin at screen {:.4f}\nset rmargin at screen {:.4f}\nset tmargin at screen {:.4f}\nset bmargin "
      "at screen {:.4f}\nset title '{}, delay {:.3g} ms' offset 0,-0.4\n",
      (left + left_px) / kWidth_px, (left + wide - right_px) / kWidth_px, (top - above_px) / height_px,
      (top - kPanelHeight_px + below_px) / height_px, name_of(axes.modes[row]), 1e3 * axes.delays_s[column]);
}

std::string panel(std::span<const PassivityRow> rows, std::size_t column, std::size_t row, const Axes& axes,
                  const TemporaryFolder& work) {
  std::string curves, rule;
  for (std::size_t n = 0; n < axes.algorithms.size(); ++n) {
    const AlgorithmId& algorithm = axes.algorithms[n];
    const double aside = std::pow(1.05, static_cast<double>(n) - 1);
    const std::string file = fmt::format("stability-{}-{}-{}.dat", name_of(algorithm), row, column);
    write_figure_data(work / file,
                      curve_data(rows, algorithm, aside, axes.modes[row], axes.delays_s[column]));
    // The same for every algorithm.
    rule = fmt::format(", '{}' using 4:5 with lines dt 2 lw 2 lc rgb '#8a8a8a' notitle", file);
    curves += fmt::format(
        "{2}'{0}' using 1:2 with linespoints pt 7 ps 0.9 lw 1.6 lc rgb '{1}' notitle, '{0}' using 1:3 with "
        "points "
        "pt 9 ps 1.9 lc rgb '{1}' notitle",
        file, algorithm.colour, curves.empty() ? "plot " : ", ");
  }
  return curves + rule + "\n";
}

std::string common(const Axes& axes, double height_px) {
  std::string tics;
  for (const double damping : axes.dampings_Ns_per_m)
    tics += fmt::format("{}{:.4g}", tics.empty() ? "" : ",", damping);
  double x = 0.5 * (kWidth_px - 200 * static_cast<double>(axes.algorithms.size()) - 300);
  const double y = 1 - 24 / height_px;
  std::string legend;
  int tag = 101;
  for (const AlgorithmId& algorithm : axes.algorithms) {
    legend += fmt::format("set label {} '● {}' at screen {:.4f},screen {:.4f} left tc rgb '{}'\n", tag++,
                          algorithm.label, x / kWidth_px, y, algorithm.colour);
    x += 200;
  }
  legend += fmt::format(
      "set label {} '- - -  2 b / (T + 2 τ), an ideal wall' at screen {:.4f},screen {:.4f} left tc "
      "rgb '#444444'\n",
      tag, x / kWidth_px, y);
  return fmt::format(
             "set multiplot\nset border 3 lc rgb '#444444'\nset tics nomirror out scale 0.6\nset grid y lc "
             "rgb "
             "'#dddddd' lt 1 lw 0.7\nset datafile missing '?'\nunset key\nset logscale xy\nset xrange "
             "[{:.4g}:{:.4g}]\nset yrange [{:.4g}:{:.4g}]\nset xtics ({})\nset format y '%g'\nset ylabel "
             "'Felt at the "
             "limit (N/mm)'\nset xlabel 'Damping of the device (N s/m)'\n",
             axes.dampings_Ns_per_m.front() / 1.3, 1.3 * axes.dampings_Ns_per_m.back(),
             std::pow(10.0, std::floor(std::log10(axes.min_N_per_mm))),
             std::pow(10.0, std::ceil(std::log10(axes.max_N_per_mm))), tics) +
         legend;
}

}  // namespace

Figure draw_passivity_figure(std::span<const PassivityRow> rows, const std::filesystem::path& folder) {
  const TemporaryFolder work;
  const Axes axes = axes_of(rows);
  const double height_px = kTop_px + kPanelHeight_px * static_cast<double>(axes.modes.size());
  FigureScript script{"stability", static_cast<int>(kWidth_px), static_cast<int>(height_px), ""};
  script.body = common(axes, height_px);
  for (std::size_t row = 0; row < axes.modes.size(); ++row) {
    for (std::size_t column = 0; column < axes.delays_s.size(); ++column) {
      script.body +=
          frame(column, row, axes, height_px) + panel(rows, column, row, axes, work) + "unset label\n";
    }
  }
  script.body += "unset multiplot\n";
  return draw_figure(script, work, folder);
}

}  // namespace osteomill
