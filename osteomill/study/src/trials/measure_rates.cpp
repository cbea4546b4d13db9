#include "osteomill/study/measure_rates.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "osteomill/base/distribution.h"
#include "osteomill/live/live_timing.h"

namespace osteomill {

namespace {

// A resolution of the paper's tables, or of barrier-shell, for which the paper has no rate (0).
struct Resolution {
  std::string_view algorithm;
  double value;
  double paper_rate_hz = 0;
  const char* unit = "";
};

const Resolution kResolutions[] = {
    {"line-proxy", 50, 984},           {"line-proxy", 100, 964},          {"line-proxy", 250, 884},
    {"line-proxy", 500, 795},          {"line-proxy", 1000, 544},         {"surface-points", 10, 974},
    {"surface-points", 20, 951},       {"surface-points", 30, 922},       {"surface-points", 50, 837},
    {"surface-points", 100, 622},      {"point-shell", 1, 127},           {"point-shell", 2, 507},
    {"point-shell", 3, 987},           {"barrier-shell", 0.26, 0, " mm"}, {"barrier-shell", 0.13, 0, " mm"},
    {"barrier-shell", 0.10, 0, " mm"},
};

// Returns the resolution as text: "50 vertices", "scale 2", "spacing 0.13 mm".
std::string text_of(const AlgorithmDescription& algorithm, const Resolution& resolution) {
  const std::string number = fmt::format("{:g}{}", resolution.value, resolution.unit);
  const std::string& name = algorithm.resolution_name;
  return name.ends_with('s') ? number + " " + name : name + " " + number;
}

struct Times {
  std::vector<double> step_us;
  SustainedRate held;
  int ticks_before = 0;
  void add(const TickRecord& record) {
    step_us.push_back(record.compute_us);
    held.add(record.busy_us());
  }
};

Times times_of(MillingTrial& trial) {
  Times touching, all;
  while (!trial.finished()) {
    const TickRecord record = trial.tick().record;
    all.add(record);
    if (record.contacts > 0) touching.add(record);
    if (touching.step_us.empty()) ++touching.ticks_before;
  }
  return touching.step_us.empty() ? all : touching;
}

// Measures the rate with absolute deadlines, as live milling does, but without real-time scheduling.
double paced_rate_hz(MillingTrial& trial, int ticks_before, double tick_s) {
  constexpr double kFor_s = 2;
  for (int n = 0; n < ticks_before; ++n) trial.tick();
  const auto period_ns = static_cast<Nanoseconds>(1e9 * tick_s);
  const Nanoseconds start_ns = monotonic_now_ns();
  Nanoseconds deadline_ns = start_ns, now_ns = start_ns;
  double ticks = 0;
  while (!trial.finished() && static_cast<double>(now_ns - start_ns) < 1e9 * kFor_s) {
    trial.tick();
    ++ticks;
    deadline_ns = next_deadline(deadline_ns, monotonic_now_ns(), period_ns).deadline_ns;
    now_ns = wait_until(deadline_ns);
  }
  return 1e9 * ticks / static_cast<double>(now_ns - start_ns);
}

}  // namespace

template <>
const std::vector<Field<RateRow>>& fields_of<RateRow>() {
  using R = RateRow;
  constexpr NumberRange kAny = NumberRange::not_negative();
  static const std::vector<Field<R>> all{
      field<R>({"points", "", kAny, "points"}, &R::points),
      field<R>({"step_us_median", "µs", kAny, "step, median"}, &R::step_us_median),
      field<R>({"step_us_p99", "µs", kAny, "step, 99th percentile"}, &R::step_us_p99),
      field<R>({"rate_hz", "Hz", kAny, "rate by CPU time"}, &R::rate_hz),
      field<R>({"steps_per_s", "", kAny, "steps a second"}, &R::steps_per_s),
      {{"paper_rate_hz", "Hz", kAny, "in the paper"},
       [](const R& row) { return row.paper_rate_hz > 0 ? row.paper_rate_hz : kNotMeasured; },
       [](R& row, double value) { row.paper_rate_hz = value; }},
      field<R>({"paced_rate_hz", "Hz", kAny, "rate achieved"}, &R::paced_rate_hz)};
  return all;
}

std::vector<RateRow> measure_rates(const TrialPlan& plan, const std::vector<AlgorithmDescription>& algorithms,
                                   const std::function<void(std::string_view, double)>& progress) {
  std::vector<RateRow> rows;
  int done = 0;
  for (const Resolution& resolution : kResolutions) {
    progress(resolution.algorithm, static_cast<double>(done++) / std::size(kResolutions));
    const auto algorithm = std::find_if(algorithms.begin(), algorithms.end(),
                                        [&](const auto& one) { return one.id == resolution.algorithm; });
    if (algorithm == algorithms.end()) continue;
    TrialSettings settings = plan.settings;
    settings.algorithm = *algorithm;
    settings.spindle = false;
    settings.haptics.named.push_back({algorithm->id.name, algorithm->resolution_setting, resolution.value});
    MillingTrial trial(plan.bone, plan.densities, plan.entry, settings);
    const Times times = times_of(trial);
    // The number of points is known only after the first contact.
    const auto same_points = [&](const RateRow& row) {
      return row.algorithm == algorithm->id && row.points == trial.algorithm().sample_point_count();
    };
    if (const auto twin = std::find_if(rows.begin(), rows.end(), same_points); twin != rows.end()) {
      twin->resolution += " and " + text_of(*algorithm, resolution);
      continue;
    }
    MillingTrial again(plan.bone, plan.densities, plan.entry, settings);
    const Distribution step_us = distribution_of(times.step_us);
    rows.push_back({algorithm->id, text_of(*algorithm, resolution), trial.algorithm().sample_point_count(),
                    step_us.median, step_us.p99, times.held.rate_hz(), 1e6 / step_us.median,
                    resolution.paper_rate_hz, paced_rate_hz(again, times.ticks_before, settings.tick_s)});
  }
  return rows;
}

}  // namespace osteomill
