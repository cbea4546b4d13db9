#include "osteomill/experiment/measure_rates.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "osteomill/numbers/distribution.h"

namespace osteomill {

namespace {

// One resolution of the paper's tables.
struct Resolution {
  AlgorithmId algorithm;
  std::optional<int> HapticSettings::*setting;
  int value;
  std::string_view unit;
  double paper_rate_hz;
};

const Resolution kPaperResolutions[] = {
    {AlgorithmId::line_proxy, &HapticSettings::vertices, 50, "vertices", 984},
    {AlgorithmId::line_proxy, &HapticSettings::vertices, 100, "vertices", 964},
    {AlgorithmId::line_proxy, &HapticSettings::vertices, 250, "vertices", 884},
    {AlgorithmId::line_proxy, &HapticSettings::vertices, 500, "vertices", 795},
    {AlgorithmId::line_proxy, &HapticSettings::vertices, 1000, "vertices", 544},
    {AlgorithmId::surface_points, &HapticSettings::slices, 10, "slices", 974},
    {AlgorithmId::surface_points, &HapticSettings::slices, 20, "slices", 951},
    {AlgorithmId::surface_points, &HapticSettings::slices, 30, "slices", 922},
    {AlgorithmId::surface_points, &HapticSettings::slices, 50, "slices", 837},
    {AlgorithmId::surface_points, &HapticSettings::slices, 100, "slices", 622},
    {AlgorithmId::point_shell, &HapticSettings::shell_scale, 1, "scale", 127},
    {AlgorithmId::point_shell, &HapticSettings::shell_scale, 2, "scale", 507},
    {AlgorithmId::point_shell, &HapticSettings::shell_scale, 3, "scale", 987},
};

std::string text_of(const Resolution& resolution) {
  const std::string number = std::to_string(resolution.value);
  const std::string unit(resolution.unit);
  return resolution.algorithm == AlgorithmId::point_shell ? unit + " " + number : number + " " + unit;
}

std::vector<double> step_times_us(MillingTrial& trial) {
  std::vector<double> touching;
  std::vector<double> all;
  while (!trial.finished()) {
    const TickRecord record = trial.tick().record;
    all.push_back(record.compute_us);
    if (record.contacts > 0) touching.push_back(record.compute_us);
  }
  return touching.empty() ? all : touching;
}

}  // namespace

std::vector<RateRow> measure_rates(const Volume& bone, const BoneDensities& densities,
                                   const MillingEntry& entry, const std::vector<AlgorithmId>& algorithms,
                                   const TrialSettings& settings,
                                   const std::function<void(std::string_view, double)>& progress) {
  std::vector<RateRow> rows;
  int done = 0;
  for (const Resolution& resolution : kPaperResolutions) {
    progress(name_of(resolution.algorithm), static_cast<double>(done++) / std::size(kPaperResolutions));
    if (std::find(algorithms.begin(), algorithms.end(), resolution.algorithm) == algorithms.end()) continue;
    TrialSettings trial_settings = settings;
    trial_settings.spindle = false;
    trial_settings.haptics.*resolution.setting = resolution.value;
    MillingTrial trial(bone, densities, entry, resolution.algorithm, trial_settings);
    const Distribution step_us = distribution_of(step_times_us(trial));
    rows.push_back({resolution.algorithm, text_of(resolution), trial.algorithm().sample_point_count(),
                    step_us.median, step_us.p99, 1e6 / step_us.median, resolution.paper_rate_hz});
  }
  return rows;
}

}  // namespace osteomill
