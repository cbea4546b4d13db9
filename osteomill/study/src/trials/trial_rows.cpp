#include "osteomill/study/trial_rows.h"

#include "osteomill/study/paper.h"

namespace osteomill {

namespace {

constexpr std::string_view kOnce[] = {"press"};

using Columns = std::vector<Field<TrialRow>>;

template <typename Place>
Field<TrialRow> column(const char* name, const char* unit, Place place, const char* doc) {
  return field<TrialRow>({name, unit, NumberRange::not_negative(), doc}, place);
}

Columns milling_columns() {
  const auto run = [](auto& row) -> auto& {
    return row.run;
  };
  Columns columns =
      joined<TrialRow>({fields_within<TrialRow>(run, fields_of<MeasuredRun>()),
                        fields_within<TrialRow>(
                            [](auto& row) -> auto& { return row.run.metrics; }, fields_of<RunMetrics>())});
  // Grip is an option of the trial; no study varies the tremor.
  std::erase_if(columns, [](const Field<TrialRow>& column) {
    return column.name == "hand_grip" || column.name == "other_tremor";
  });
  return columns;
}

Columns wall_columns() {
  return {column(
              "passive", "", [](auto& row) -> auto& { return row.wall.passive; }, "share that stays passive"),
          column(
              "carries", "", [](auto& row) -> auto& { return row.wall.carries; }, "share that carries 0.5 N"),
          column(
              "felt_N_per_mm", "N/mm", [](auto& row) -> auto& { return row.wall.felt_N_per_mm; },
              "felt stiffness"),
          column(
              "rule_N_per_mm", "N/mm", [](auto& row) -> auto& { return row.wall.rule_N_per_mm; },
              "2 b / (T + 2 τ)")};
}

}  // namespace

std::span<const std::string_view> parts_of(StudyTest test) {
  if (test == StudyTest::milling) return kPhases;
  return kOnce;
}

const Columns& columns_of(StudyTest test) {
  static const Columns milling = milling_columns(), wall = wall_columns();
  return test == StudyTest::milling ? milling : wall;
}

WallFigures wall_figures(const TrialSettings& settings, const WallPressResult& result) {
  WallFigures figures{.rule_N_per_mm =
                          passive_stiffness_rule_N_per_mm(settings.device_damping_Ns_per_mm, settings.tick_s,
                                                          settings.hand_and_device.handle.force_delay_s)};
  if (result.motion == WallMotion::yields) return figures;
  figures.carries = 1;
  figures.passive = result.motion == WallMotion::decays ? 1 : 0;
  figures.felt_N_per_mm = result.felt_N_per_mm;
  return figures;
}

}  // namespace osteomill
