#include "osteomill/experiment/passivity_section.h"

#include <algorithm>
#include <ostream>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "osteomill/files/atomic_file.h"
#include "osteomill/report/html.h"
#include "osteomill/report/run_groups.h"

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

std::vector<AlgorithmId> algorithms_of(std::span<const PassivityRow> rows, Mode mode) {
  std::vector<AlgorithmId> present;
  for (const PassivityRow& row : rows) {
    if (row.setup.mode == mode) present.push_back(row.setup.algorithm.id);
  }
  return each_once(std::move(present));
}

// A line a device, in the order of the first algorithm's rows.
std::string mode_table(std::span<const PassivityRow> rows, Mode mode) {
  const auto algorithms = algorithms_of(rows, mode);
  HtmlTable table{{"Device: damping, delay", "2 b / (T + 2 τ)"}, {}, true};
  for (const AlgorithmId& algorithm : algorithms) table.header.emplace_back(algorithm.label);
  for (const PassivityRow& device : rows) {
    if (device.setup.mode != mode || device.setup.algorithm.id != algorithms.front()) continue;
    table.rows.push_back({fmt::format("{:.3g} N s/m, {:.3g} ms", 1e3 * device.setup.damping_Ns_per_mm,
                                      1e3 * device.setup.delay_s),
                          fmt::format("{:.3g}", device.rule_N_per_mm)});
    for (const AlgorithmId& algorithm : algorithms) {
      const auto row = std::find_if(rows.begin(), rows.end(), [&](const PassivityRow& of) {
        return of.setup.mode == mode && of.setup.algorithm.id == algorithm &&
               of.setup.delay_s == device.setup.delay_s &&
               of.setup.damping_Ns_per_mm == device.setup.damping_Ns_per_mm;
      });
      table.rows.back().push_back(row == rows.end() ? "–" : cell(*row));
    }
  }
  return html_table(table);
}

// "1 line-proxy 0.98 to 1.05"
std::string range_against_rule(std::span<const PassivityRow> rows, const AlgorithmId& algorithm, Mode mode) {
  std::vector<double> ratios;
  std::size_t none = 0;
  for (const PassivityRow& row : rows) {
    if (row.setup.algorithm.id != algorithm || row.setup.mode != mode) continue;
    if (row.limit.kind == Kind::below_all) {
      ++none;
    } else {
      ratios.push_back(row.limit.felt_N_per_mm / row.rule_N_per_mm);
    }
  }
  const std::string& name = algorithm.label;
  if (ratios.empty()) return name + " passive on no device";
  const auto [min, max] = std::minmax_element(ratios.begin(), ratios.end());
  const std::string range = fmt::format("{} {:.2f} to {:.2f}", name, *min, *max);
  if (none == 0) return range;
  return fmt::format("{}, and passive at no stiffness on {} of {} devices", range, none,
                     none + ratios.size());
}

std::string in_words(std::span<const PassivityRow> rows, Mode mode) {
  std::string text;
  for (const AlgorithmId& algorithm : algorithms_of(rows, mode)) {
    text += (text.empty() ? "" : "; ") + range_against_rule(rows, algorithm, mode);
  }
  return "The stiffness felt at the limit, as a multiple of the rule: " + text + ".";
}

constexpr const char* kWhatWasDone =
    "The device alone, without a hand, is pressed on a flat wall of bone by 0.5 N along a guide, and then "
    "given "
    "a small speed. The greatest --stiffness is sought at which its swings die out: at which the wall, the "
    "device's delay and the tick together do not put more energy into a swing than the device's own damping "
    "takes. An ideal wall of stiffness K, sampled every T = 1 ms and felt with a delay τ, should stay so up "
    "to "
    "K = 2 b / (T + 2 τ) on a device with damping b. What is felt of an algorithm's setting is the slope of "
    "its "
    "force over the depth at 0.5 N; that is what the rule speaks of. Bisection finds one limit; an algorithm "
    "that buzzes by itself may have others.";

constexpr const char* kCaption =
    "The stiffness felt where the wall is only just passive, against the device's damping. A triangle: "
    "passive "
    "up to the stiffest setting tried, 200 N/mm, of which this is felt. A missing point: passive at no "
    "setting. "
    "Points stand a little aside of each other.";

}  // namespace

std::string passivity_section(std::span<const PassivityRow> rows, const Figure& figure) {
  std::string html = "<h2>Stability against a flat wall</h2>\n<p>" + html_escaped(kWhatWasDone) + "</p>\n" +
                     html_figure(figure.svg, kCaption);
  for (const Mode mode : {Mode::paper, Mode::steady}) {
    if (algorithms_of(rows, mode).empty()) continue;
    html += fmt::format(
        "<h3>Greatest passive stiffness in N/mm, mode {}: setting → felt (against the rule)</h3>\n",
        name_of(mode));
    html += "<p>" + html_escaped(in_words(rows, mode)) + "</p>\n" + mode_table(rows, mode);
  }
  return html;
}

void write_passivity_csv(const std::filesystem::path& path, std::span<const PassivityRow> rows) {
  write_text_atomically(path, [&](std::ostream& out) {
    out << "algorithm,mode,device_damping_Ns_per_m,device_delay_s,limit,stiffness_N_per_mm,felt_N_per_mm,"
           "rule_N_per_mm\n";
    for (const PassivityRow& row : rows) {
      const PassivityCase& setup = row.setup;
      out << fmt::format("{},{},{},{},{},{},{},{}\n", setup.algorithm.id.name, name_of(setup.mode),
                         1e3 * setup.damping_Ns_per_mm, setup.delay_s, name_of_kind(row.limit.kind),
                         row.limit.stiffness_N_per_mm, row.limit.felt_N_per_mm, row.rule_N_per_mm);
    }
  });
}

}  // namespace osteomill
