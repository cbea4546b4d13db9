#include <stdexcept>

#include "verification/in_parallel.h"
#include "verification/sections.h"
#include "verification/trial_figures.h"
#include <fmt/core.h>

namespace osteomill::verification {

namespace {

// The settings in which `steady` differs from `paper`, as `paper` has them.
std::vector<HapticSettings::Named> switches_off(std::string_view algorithm) {
  const AlgorithmDescription& described = algorithm_named(algorithm);
  HapticSettings paper;
  paper.mode = Mode::paper;
  const auto as_printed = setting_values(described, paper);
  const auto improved = setting_values(described, HapticSettings{});
  std::vector<HapticSettings::Named> off;
  for (std::size_t n = 0; n < as_printed.size(); ++n) {
    if (as_printed[n].value == improved[n].value) continue;
    off.push_back({described.id.name, as_printed[n].name, as_printed[n].value});
  }
  return off;
}

// One line of the table: steady, or steady without one switch.
struct Line {
  std::string name;
  std::vector<HapticSettings::Named> named;
  std::vector<std::string> cells;
};

void measure(Line& line, std::string_view algorithm, const Volume& bone, double phase_s) {
  for (const double push_N : {1.5, 3.0}) {
    try {
      const TrialFigures f = milling_figures(bone, {.algorithm = std::string(algorithm),
                                                    .push_N = push_N,
                                                    .seed = 11,
                                                    .phase_s = phase_s,
                                                    .named = line.named});
      line.cells.push_back(fmt::format("{} / {} / {}", figure(f.hp_over_mean()),
                                       figure(f.metrics.torque_Nmm.step_max),
                                       figure(f.metrics.force_N.step_max)));
      line.cells.push_back(
          fmt::format("{} / {}", figure(f.metrics.step_us.median), figure(f.metrics.step_us.p99)));
    } catch (const std::invalid_argument& error) {
      line.cells = {error.what(), "", "", ""};
      return;
    }
  }
}

}  // namespace

Section switch_by_switch(const Bones& bones, const Effort& effort) {
  Section section{
      "Switch by switch",
      fmt::format("`steady`, then with one switch at a time as `paper` has it, and `paper` itself; "
                  "milling {} for {:.0f} s, seed 11. Force above 20 Hz over its mean / largest torque "
                  "step (N mm) / largest force step (N); step median / 99 % in us, with another trial "
                  "beside. Reported; what each switch is for stands in algorithms.md, and not every "
                  "defect shows here.",
                  bones.tooth_name, effort.phase_s),
      {"algorithm, without", "push 1.5 N", "step, us", "push 3 N", "step, us"},
      {},
      {}};
  for (const std::string& algorithm : algorithm_names()) {
    std::vector<Line> lines{{"nothing (steady)", {}, {}}};
    const std::vector<HapticSettings::Named> off = switches_off(algorithm);
    for (const HapticSettings::Named& named : off) lines.push_back({"`" + named.setting + "`", {named}, {}});
    lines.push_back({"any (paper)", off, {}});
    in_parallel(lines.size(),
                [&](std::size_t n) { measure(lines[n], algorithm, bones.tooth, effort.phase_s); });
    for (Line& line : lines) {
      line.cells.insert(line.cells.begin(), fmt::format("{}, {}", algorithm, line.name));
      section.rows.push_back(line.cells);
    }
  }
  return section;
}

}  // namespace osteomill::verification
