#include "osteomill/report/metric_table.h"

#include <cmath>

#include <fmt/format.h>

namespace osteomill {

namespace {

using M = RunMetrics;
using T = MetricTable;

constexpr Metric kMetrics[] = {
    {"steps", "", [](M& m) -> double& { return m.steps; }, T::times, "Ticks", "{:.0f}"},
    {"step_us_median", "µs", [](M& m) -> double& { return m.step_us.median; }},
    {"step_us_p99", "µs", [](M& m) -> double& { return m.step_us.p99; }},
    {"step_us_max", "µs", [](M& m) -> double& { return m.step_us.max; }},
    {"rate_hz", "Hz", [](M& m) -> double& { return m.rate_hz; }, T::rate,
     "Haptic rate that a 1 kHz loop would hold", "{:.1f}"},
    {"force_mean_N", "N", [](M& m) -> double& { return m.force_N.mean; }, T::force,
     "Force while in contact, mean"},
    {"force_max_N", "N", [](M& m) -> double& { return m.force_N.max; }, T::force, "… greatest"},
    {"force_hp_rms_N", "N", [](M& m) -> double& { return m.force_N.hp_rms; }, T::force, "… above 20 Hz, rms",
     "{:.4g}", 1, "force above 20 Hz, rms", true},
    {"", "", [](M& m) -> double& { return m.force_N.hp_share; }, T::none, "", "", 2,
     "force above 20 Hz / mean force"},
    {"force_step_max_N", "N", [](M& m) -> double& { return m.force_N.step_max; }, T::force,
     "… greatest change in a tick", "{:.4g}", 3, "greatest force step", true},
    {"torque_mean_Nmm", "N mm", [](M& m) -> double& { return m.torque_Nmm.mean; }, T::torque,
     "Torque while in contact, mean", "{:.4g}", 6, "mean torque"},
    {"torque_max_Nmm", "N mm", [](M& m) -> double& { return m.torque_Nmm.max; }, T::torque, "… greatest"},
    {"torque_hp_rms_Nmm", "N mm", [](M& m) -> double& { return m.torque_Nmm.hp_rms; }, T::torque,
     "… above 20 Hz, rms", "{:.4g}", 4, "torque above 20 Hz, rms", true},
    {"torque_step_max_Nmm", "N mm", [](M& m) -> double& { return m.torque_Nmm.step_max; }, T::torque,
     "… greatest change in a tick", "{:.4g}", 5, "greatest torque step", true},
    {"shaft_spread_deg", "degrees", [](M& m) -> double& { return m.shaft.spread_deg; }, T::shaft,
     "Shaft direction, spread", "{:.4g}", 7, "spread of the shaft", true},
    {"shaft_excursion_deg", "degrees", [](M& m) -> double& { return m.shaft.excursion_deg; }, T::shaft,
     "… greatest excursion"},
    {"removed_mm3", "mm³", [](M& m) -> double& { return m.removed_mm3; }, T::path, "Bone removed", "{:.4g}",
     8, "bone removed"},
    {"", "mm", [](M& m) -> double& { return m.path_mm; }, T::path, "Path of the burr's centre"},
    {"contact_share", "", [](M& m) -> double& { return m.contact.any; }, T::path,
     "In contact, share of the time"},
    {"burr_contact_share", "", [](M& m) -> double& { return m.contact.burr; }, T::path, "… with the burr"},
    {"shaft_contact_share", "", [](M& m) -> double& { return m.contact.shaft; }, T::path, "… with the shaft"},
    {"tick_us_median", "µs", [](M& m) -> double& { return m.tick_us.median; }, T::times,
     "Compute time of a tick, median", "{:.4g}", 9, "compute time of a tick, median", true},
    {"tick_us_p99", "µs", [](M& m) -> double& { return m.tick_us.p99; }, T::times, "… 99th percentile",
     "{:.4g}", 10, "compute time of a tick, 99th percentile"},
    {"tick_us_max", "µs", [](M& m) -> double& { return m.tick_us.max; }, T::times, "… greatest"},
    {"turn_50ms_max_deg", "degrees", [](M& m) -> double& { return m.turns.max_deg; }},
    {"turn_at_torque_step_deg", "degrees", [](M& m) -> double& { return m.turns.at_torque_step_deg; }},
    {"torque_follows_force", "", [](M& m) -> double& { return m.torque_follows_force; }},
    {"contacts_mean", "", [](M& m) -> double& { return m.contacts_mean; }},
    {"lost_after_s", "s", [](M& m) -> double& { return m.contact.lost_after_s; }},
};

}  // namespace

std::span<const Metric> all_metrics() {
  return kMetrics;
}

const std::vector<Metric>& summary_metrics() {
  static const std::vector<Metric> columns = [] {
    std::vector<Metric> with_column(std::begin(kMetrics), std::end(kMetrics));
    std::erase_if(with_column, [](const Metric& metric) { return *metric.column == '\0'; });
    return with_column;
  }();
  return columns;
}

std::string csv_number(double value) {
  return std::isnan(value) ? "," : fmt::format(",{}", value);
}

std::string with_unit(const char* text, const Metric& metric) {
  return *metric.unit == '\0' ? text : fmt::format("{} ({})", text, metric.unit);
}

std::string summary_columns() {
  std::string columns = "algorithm,phase";
  for (const Metric& metric : summary_metrics()) columns += fmt::format(",{}", metric.column);
  return columns + ",not_reached";
}

std::string summary_fields(const MeasuredRun& run) {
  std::string fields = fmt::format("{},{}", name_of(run.algorithm), run.phase);
  for (const Metric& metric : summary_metrics()) fields += csv_number(metric(run.metrics));
  return fields + "," + run.not_reached;
}

}  // namespace osteomill
