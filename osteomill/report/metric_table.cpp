#include "osteomill/report/metric_table.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace osteomill {

namespace {

using M = RunMetrics;

template <typename Place>
Field<M> figure(const char* column, const char* unit, Place place, const char* doc, unsigned flags = 0) {
  return field<M>({column, unit, NumberRange::finite(), doc, flags}, place);
}

std::vector<Field<M>> all_figures() {
  constexpr unsigned kTime = kLessIsBetter | kOfTheMachine;
  return {
      figure("steps", "", &M::steps, "ticks"),
      figure(
          "step_us_median", "µs", [](auto& m) -> auto& { return m.step_us.median; },
          "compute time of a step, median", kTime),
      figure(
          "step_us_p99", "µs", [](auto& m) -> auto& { return m.step_us.p99; },
          "compute time of a step, 99th percentile", kTime),
      figure(
          "step_us_max", "µs", [](auto& m) -> auto& { return m.step_us.max; },
          "compute time of a step, greatest", kTime),
      figure("rate_hz", "Hz", &M::rate_hz, "haptic rate that a 1 kHz loop would hold", kOfTheMachine),
      figure(
          "force_mean_N", "N", [](auto& m) -> auto& { return m.force_N.mean; }, "mean force"),
      figure(
          "force_max_N", "N", [](auto& m) -> auto& { return m.force_N.max; }, "greatest force"),
      figure(
          "force_hp_rms_N", "N", [](auto& m) -> auto& { return m.force_N.hp_rms; }, "force above 20 Hz, rms",
          kLessIsBetter),
      figure(
          "force_step_max_N", "N", [](auto& m) -> auto& { return m.force_N.step_max; }, "greatest force step",
          kLessIsBetter),
      figure(
          "torque_mean_Nmm", "N mm", [](auto& m) -> auto& { return m.torque_Nmm.mean; }, "mean torque"),
      figure(
          "torque_max_Nmm", "N mm", [](auto& m) -> auto& { return m.torque_Nmm.max; }, "greatest torque"),
      figure(
          "torque_hp_rms_Nmm", "N mm", [](auto& m) -> auto& { return m.torque_Nmm.hp_rms; },
          "torque above 20 Hz, rms", kLessIsBetter),
      figure(
          "torque_step_max_Nmm", "N mm", [](auto& m) -> auto& { return m.torque_Nmm.step_max; },
          "greatest torque step", kLessIsBetter),
      figure(
          "shaft_spread_deg", "degrees", [](auto& m) -> auto& { return m.shaft.spread_deg; },
          "spread of the shaft", kLessIsBetter),
      figure(
          "shaft_excursion_deg", "degrees", [](auto& m) -> auto& { return m.shaft.excursion_deg; },
          "greatest excursion of the shaft"),
      figure("removed_mm3", "mm³", &M::removed_mm3, "bone removed"),
      figure(
          "contact_share", "", [](auto& m) -> auto& { return m.contact.any; },
          "in contact, share of the time"),
      figure(
          "burr_contact_share", "", [](auto& m) -> auto& { return m.contact.burr; },
          "in contact with the burr, share of the time"),
      figure(
          "shaft_contact_share", "", [](auto& m) -> auto& { return m.contact.shaft; },
          "in contact with the shaft, share of the time"),
      figure(
          "tick_us_median", "µs", [](auto& m) -> auto& { return m.tick_us.median; },
          "compute time of a tick, median", kTime),
      figure(
          "tick_us_p99", "µs", [](auto& m) -> auto& { return m.tick_us.p99; },
          "compute time of a tick, 99th percentile", kOfTheMachine),
      figure(
          "tick_us_max", "µs", [](auto& m) -> auto& { return m.tick_us.max; },
          "compute time of a tick, greatest", kTime),
      figure(
          "turn_50ms_max_deg", "degrees", [](auto& m) -> auto& { return m.turns.max_deg; },
          "greatest turn of the shaft within 50 ms"),
      figure(
          "turn_at_torque_step_deg", "degrees", [](auto& m) -> auto& { return m.turns.at_torque_step_deg; },
          "turn of the shaft within 50 ms about the greatest torque step"),
      figure("torque_follows_force", "", &M::torque_follows_force,
             "share of the torque above 20 Hz that follows the force"),
      figure("contacts_mean", "", &M::contacts_mean, "sample points that touch, mean"),
      figure(
          "lost_after_s", "s", [](auto& m) -> auto& { return m.contact.lost_after_s; },
          "when contact was lost"),
      figure(
          "lost_while_milling", "", [](auto& m) -> auto& { return m.contact.lost_while_milling; },
          "whether contact was lost while the spindle turned"),
      figure(
          "force_contact_share", "", [](auto& m) -> auto& { return m.contact.force; },
          "a force felt, share of the time"),
      figure(
          "torque_contact_share", "", [](auto& m) -> auto& { return m.contact.torque; },
          "a torque felt, share of the time"),
      figure(
          "force_hp_share", "", [](auto& m) -> auto& { return m.force_N.hp_share; },
          "force above 20 Hz / mean force"),
      figure(
          "torque_hp_share", "", [](auto& m) -> auto& { return m.torque_Nmm.hp_share; },
          "torque above 20 Hz / mean torque"),
      figure("path_mm", "mm", &M::path_mm, "path of the burr's centre"),
      figure("put_back_mm3", "mm³", &M::put_back_mm3, "bone put back"),
      figure("counted_from_s", "s", &M::counted_from_s, "from when on it is counted"),
  };
}

}  // namespace

template <>
const std::vector<Field<RunMetrics>>& fields_of<RunMetrics>() {
  static const std::vector<Field<RunMetrics>> all = all_figures();
  return all;
}

const Field<RunMetrics>& metric(std::string_view column) {
  if (const Field<RunMetrics>* found = find_field(fields_of<RunMetrics>(), column)) return *found;
  throw std::invalid_argument(fmt::format("a run has no figure {}", column));
}

std::string csv_number(double value) {
  return std::isnan(value) ? "," : fmt::format(",{}", value);
}

std::string with_unit(const std::string& text, const std::string& unit) {
  return unit.empty() ? text : fmt::format("{} ({})", text, unit);
}

std::string summary_columns() {
  std::string columns = "algorithm,phase";
  for (const Field<RunMetrics>& figure : fields_of<RunMetrics>()) columns += "," + figure.name;
  return columns + ",not_reached";
}

std::string summary_fields(const MeasuredRun& run) {
  std::string fields = fmt::format("{},{}", name_of(run.algorithm), run.phase);
  for (const Field<RunMetrics>& figure : fields_of<RunMetrics>())
    fields += csv_number(figure.get(run.metrics));
  return fields + "," + run.not_reached;
}

}  // namespace osteomill
