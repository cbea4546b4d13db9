#include "osteomill/experiment/trial_rows.h"

#include <fmt/format.h>

#include "osteomill/experiment/paper.h"

namespace osteomill {

namespace {

constexpr std::string_view kOnce[] = {"press"};

std::vector<StudyColumn> milling_columns() {
  std::vector<StudyColumn> columns{{"hand_stiffness_N_per_m", "stiffness of the hand (N/m)"},
                                   {"hand_damping_Ns_per_m", "damping of the hand (N s/m)"}};
  for (const Metric& metric : summary_metrics()) {
    const bool has_label = *metric.label != '\0' && !std::string_view(metric.label).starts_with("…");
    const char* words = *metric.name != '\0' ? metric.name : has_label ? metric.label : metric.column;
    columns.push_back({metric.column, words == metric.column ? words : with_unit(words, metric)});
  }
  return columns;
}

// What follows from the columns: in these trials the spindle turns throughout the milling, and not while
// holding.
void complete_metrics(MeasuredRun& run) {
  RunMetrics& m = run.metrics;
  for (VectorMetrics* felt : {&m.force_N, &m.torque_Nmm})
    felt->hp_share = felt->mean == 0 ? 0 : felt->hp_rms / felt->mean;
  m.contact.force = m.contact.torque = m.contact.any;
  m.contact.lost_while_milling = m.contact.is_lost() && (run.phase == kMilling) == (m.contact.any > 0);
}

}  // namespace

std::span<const std::string_view> parts_of(StudyTest test) {
  if (test == StudyTest::milling) return kPhases;
  return kOnce;
}

const std::vector<StudyColumn>& columns_of(StudyTest test) {
  static const std::vector<StudyColumn> milling = milling_columns();
  static const std::vector<StudyColumn> wall{{"passive", "share that stays passive"},
                                             {"carries", "share that carries 0.5 N"},
                                             {"felt_N_per_mm", "felt stiffness (N/mm)"},
                                             {"rule_N_per_mm", "2 b / (T + 2 τ) (N/mm)"}};
  return test == StudyTest::milling ? milling : wall;
}

TrialRow as_row(const StudyRow& row) {
  TrialRow out{.part = phase_number(row.run.phase),
               .values = {row.stiffness_N_per_m, row.damping_Ns_per_m},
               .not_reached = row.run.not_reached};
  for (const Metric& metric : summary_metrics()) out.values.push_back(metric(row.run.metrics));
  return out;
}

StudyRow milling_row(const TrialRow& row, StudyRow of) {
  auto value = row.values.begin();
  of.stiffness_N_per_m = *value++;
  of.damping_Ns_per_m = *value++;
  of.run.phase = kPhases[row.part];
  of.run.not_reached = row.not_reached;
  for (const Metric& metric : summary_metrics()) metric.place(of.run.metrics) = *value++;
  complete_metrics(of.run);
  return of;
}

TrialRow as_row(const TrialSettings& settings, const WallPressResult& result) {
  const bool carries = result.motion != WallMotion::gives_way;
  return {.values = {carries ? (result.motion == WallMotion::dies_out ? 1.0 : 0.0) : kNotMeasured,
                     carries ? 1.0 : 0.0, carries ? result.felt_N_per_mm : kNotMeasured,
                     passive_stiffness_rule_N_per_mm(settings.device_damping_Ns_per_mm, settings.tick_s,
                                                     settings.hand_and_device.handle.force_delay_s)}};
}

}  // namespace osteomill
