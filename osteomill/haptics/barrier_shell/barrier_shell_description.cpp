#include "osteomill/haptics/barrier_shell/barrier_shell_description.h"

#include <vector>

#include "osteomill/haptics/barrier_shell/barrier_shell.h"
#include "osteomill/haptics/setting_fields.h"
#include "osteomill/haptics/tool_move.h"

namespace osteomill::barrier_shell {

namespace {

using Field = SettingField<Settings>;

const AlgorithmId& id() {
  static const AlgorithmId self{"barrier-shell", "4 barrier-shell", "#1565c0"};
  return self;
}

// The same in both modes: it has one.
template <typename Place>
Field number(const char* name, const char* unit, double value, const char* meaning, Place place,
             const char* option = "") {
  return setting_field<Settings>({.name = name,
                                  .unit = unit,
                                  .range = SettingRange::positive(),
                                  .paper = value,
                                  .steady = value,
                                  .meaning = meaning,
                                  .option = option},
                                 place);
}

const std::vector<Field>& fields() {
  static const std::vector<Field> all{
      number(
          "translational-stiffness", "N/mm", 2, "Virtual coupling between device and simulated tool",
          [](Settings & s) -> auto& { return s.translational_stiffness_N_per_mm; }, "stiffness"),
      number(
          "torsional-stiffness", "N mm/rad", 1000, "The same about rotation",
          [](Settings & s) -> auto& { return s.torsional_stiffness_Nmm_per_rad; }, "torsional-stiffness"),
      number(
          "skin-width", "mm", 0.25,
          "How far from the tool's cores bone is felt; less where the rounding is less",
          [](Settings & s) -> auto& { return s.skin_width_mm; }),
      number(
          "rounding", "mm", 0.212, "How far the cores lie within the tool, at most half of its least radius",
          [](Settings & s) -> auto& { return s.rounding_mm; }),
      number(
          "pressure", "N/mm2", 3,
          "p0 of the skin's pressure p0 / 3 x^2 (3 - 2 x) / (1 - x)^2, for the default burr; of another it "
          "goes against its section",
          [](Settings & s) -> auto& { return s.pressure_N_per_mm2; }),
      number(
          "point-spacing", "mm", BoneBricks::kSpacing_mm,
          "How far apart the points of bone lie at most, whatever the scan's voxels; twice as far at the "
          "shaft where the bone is flat",
          [](Settings & s) -> auto& { return s.point_spacing_mm; }),
      number(
          "release-time", "s", Release{}.time_s,
          "In which a stretch of the coupling that nothing holds any more falls to a third, if not sooner by "
          "the next two",
          [](Settings & s) -> auto& { return s.release_time_s; }),
      number(
          "release", "mm/s", Release{}.mm_s,
          "How fast the tool may move beside what the device's own move leads it to",
          [](Settings & s) -> auto& { return s.release_mm_s; }),
      number(
          "release-turn", "rad/s", Release{}.rad_s, "The same of its turning",
          [](Settings & s) -> auto& { return s.release_rad_s; }),
  };
  return all;
}

}  // namespace

Settings Settings::defaults() {
  return settings_in<Settings>(Mode::steady, fields());
}

void require_valid(const Settings& settings) {
  require_in_range<Settings>(id(), settings, fields());
}

AlgorithmDescription description() {
  return with_settings<BarrierShell, Settings>(
      {.id = id(),
       .summary = "The tool rests on a soft skin of the bone's points that nothing pushes through",
       .resolution_setting = "point-spacing",
       .resolution_name = "spacing",
       .settings = {},
       .make = {}},
      fields());
}

}  // namespace osteomill::barrier_shell
