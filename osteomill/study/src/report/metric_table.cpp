#include "osteomill/study/metric_table.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace osteomill {

namespace {

using M = RunMetrics;

template <typename Place>
Field<M> figure(std::string column, const char* unit, Place place, std::string doc, unsigned flags = 0) {
  return field<M>({std::move(column), unit, NumberRange::finite(), std::move(doc), flags}, place);
}

constexpr unsigned kTime = kLowerIsBetter | kMachineDependent;

void add_times(std::vector<Field<M>>& all, const std::string& of, Distribution M::*times) {
  const auto add = [&](const char* name, double Distribution::*place, const char* doc, unsigned flags) {
    all.push_back(figure(
        of + "_us_" + name, "µs", [=](auto& m) -> auto& { return m.*times.*place; },
        "compute time of a " + of + ", " + doc, flags));
  };
  add("median", &Distribution::median, "median", kTime);
  add("p99", &Distribution::p99, "99th percentile", kMachineDependent);
  add("max", &Distribution::max, "greatest", kTime);
}

void add_felt(std::vector<Field<M>>& all, const std::string& what, const char* unit,
              const std::string& ending, VectorMetrics M::*felt) {
  const auto add = [&](const std::string& name, double VectorMetrics::*place, const std::string& doc,
                       unsigned flags = 0) {
    all.push_back(figure(
        what + name + ending, unit, [=](auto& m) -> auto& { return m.*felt.*place; }, doc, flags));
  };
  add("_mean_", &VectorMetrics::mean, "mean " + what);
  add("_max_", &VectorMetrics::max, "greatest " + what);
  add("_hp_rms_", &VectorMetrics::hp_rms, what + " above 20 Hz, rms", kLowerIsBetter);
  add("_step_max_", &VectorMetrics::step_max, "greatest " + what + " step", kLowerIsBetter);
}

void add_contact(std::vector<Field<M>>& all, const char* column, double ContactShares::*place,
                 const char* doc) {
  all.push_back(figure(
      column, "", [=](auto& m) -> auto& { return m.contact.*place; }, doc));
}

std::vector<Field<M>> all_figures() {
  std::vector<Field<M>> all{figure("steps", "", &M::steps, "ticks")};
  const auto add = [&](const char* column, const char* unit, auto place, const char* doc,
                       unsigned flags = 0) { all.push_back(figure(column, unit, place, doc, flags)); };
  using C = ContactShares;
  add_times(all, "step", &M::step_us);
  add("rate_hz", "Hz", &M::rate_hz, "haptic rate that a 1 kHz loop would hold", kMachineDependent);
  add_felt(all, "force", "N", "N", &M::force_N);
  add_felt(all, "torque", "N mm", "Nmm", &M::torque_Nmm);
  add(
      "shaft_spread_deg", "degrees", [](auto& m) -> auto& { return m.shaft.spread_deg; },
      "spread of the shaft", kLowerIsBetter);
  add(
      "shaft_excursion_deg", "degrees", [](auto& m) -> auto& { return m.shaft.excursion_deg; },
      "greatest excursion of the shaft");
  add("removed_mm3", "mm³", &M::removed_mm3, "bone removed");
  add_contact(all, "contact_share", &C::any, "in contact, share of the time");
  add_contact(all, "burr_contact_share", &C::burr, "in contact with the burr, share of the time");
  add_contact(all, "shaft_contact_share", &C::shaft, "in contact with the shaft, share of the time");
  add_times(all, "tick", &M::tick_us);
  add(
      "turn_50ms_max_deg", "degrees", [](auto& m) -> auto& { return m.turns.max_deg; },
      "greatest turn of the shaft within 50 ms");
  add(
      "turn_at_torque_step_deg", "degrees", [](auto& m) -> auto& { return m.turns.at_torque_step_deg; },
      "turn of the shaft within 50 ms about the greatest torque step");
  add("torque_follows_force", "", &M::torque_follows_force,
      "multiple correlation of the torque with the force, both above 20 Hz");
  add("contacts_mean", "", &M::contacts_mean, "sample points in contact, mean");
  add(
      "lost_after_s", "s", [](auto& m) -> auto& { return m.contact.lost_after_s; }, "when contact was lost");
  add(
      "lost_while_milling", "", [](auto& m) -> auto& { return m.contact.lost_while_milling; },
      "whether contact was lost while the spindle turned");
  add_contact(all, "force_contact_share", &C::force, "a force felt, share of the time");
  add_contact(all, "torque_contact_share", &C::torque, "a torque felt, share of the time");
  add(
      "force_hp_share", "", [](auto& m) -> auto& { return m.force_N.hp_share; },
      "force above 20 Hz / mean force");
  add(
      "torque_hp_share", "", [](auto& m) -> auto& { return m.torque_Nmm.hp_share; },
      "torque above 20 Hz / mean torque");
  add("path_mm", "mm", &M::path_mm, "path of the burr's centre");
  add("burr_excursion_mm", "mm", &M::burr_excursion_mm, "greatest excursion of the burr's centre");
  add("put_back_mm3", "mm³", &M::put_back_mm3, "bone put back");
  add("shaft_from_handle_deg", "degrees", &M::shaft_from_handle_deg, "spread of the shaft against the handle",
      kLowerIsBetter);
  add("removal_mm3_per_s", "mm³/s", &M::removal_mm3_per_s, "bone removed per second of cutting");
  add("counted_from_s", "s", &M::counted_from_s, "start of the counted ticks");
  return all;
}

}  // namespace

template <>
const std::vector<Field<RunMetrics>>& fields_of<RunMetrics>() {
  static const std::vector<Field<RunMetrics>> all = all_figures();
  return all;
}

template <>
const std::vector<Field<MeasuredRun>>& fields_of<MeasuredRun>() {
  using R = MeasuredRun;
  constexpr NumberRange kAny = NumberRange::not_negative();
  static const std::vector<Field<R>> all{
      field<R>({"hand_stiffness_N_per_m", "N/m", kAny, "stiffness of the hand"}, &R::hand_stiffness_N_per_m),
      field<R>({"hand_damping_Ns_per_m", "N s/m", kAny, "damping of the hand"}, &R::hand_damping_Ns_per_m),
      field<R>({"hand_grip", "", kAny, "firmness of the hand's grip"}, &R::grip),
      field<R>({"other_tremor", "", kAny, "number of another tremor in the same hand"}, &R::other_tremor)};
  return all;
}

const Field<RunMetrics>& metric(std::string_view column) {
  if (const Field<RunMetrics>* found = find_field(fields_of<RunMetrics>(), column)) return *found;
  throw std::invalid_argument(fmt::format("a run has no figure {}", column));
}

std::string csv_value(double value) {
  return std::isnan(value) ? "," : fmt::format(",{}", value);
}

std::string with_unit(const std::string& text, const std::string& unit) {
  return unit.empty() ? text : fmt::format("{} ({})", text, unit);
}

std::string summary_columns() {
  return "algorithm,phase" + csv_names(fields_of<RunMetrics>()) + ",not_reached";
}

std::string summary_fields(const MeasuredRun& run) {
  return fmt::format("{},{}{},{}", name_of(run.algorithm), run.phase,
                     csv_values(fields_of<RunMetrics>(), run.metrics), run.not_reached);
}

}  // namespace osteomill
