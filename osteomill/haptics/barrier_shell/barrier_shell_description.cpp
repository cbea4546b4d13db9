#include <vector>

#include "osteomill/haptics/barrier_shell/barrier_shell.h"
#include "osteomill/haptics/setting_fields.h"
#include "osteomill/haptics/tool_move.h"

namespace osteomill::barrier_shell {

namespace {

using Field = SettingField<Settings>;

template <auto kPlace>
Field number(const char* name, const char* unit, double value, const char* meaning, const char* option = "") {
  return setting_field<kPlace>({name, unit, SettingRange::positive(), value, meaning, option});
}

const std::vector<Field>& fields() {
  static const std::vector<Field> all{
      number<&Settings::translational_stiffness_N_per_mm>(
          "translational-stiffness", "N/mm", 2, "Virtual coupling between device and simulated tool",
          "stiffness"),
      number<&Settings::torsional_stiffness_Nmm_per_rad>(
          "torsional-stiffness", "N mm/rad", 1000, "Of the coupling, about rotation", "torsional-stiffness"),
      number<&Settings::skin_width_mm>(
          "skin-width", "mm", 0.25,
          "How far from the tool's cores bone is felt; less where the rounding is less"),
      number<&Settings::rounding_mm>(
          "rounding", "mm", 0.212, "How far the cores lie within the tool, at most half of its least radius"),
      number<&Settings::pressure_N_per_mm2>(
          "pressure", "N/mm2", 3,
          "p0 of the skin's pressure p0 / 3 x^2 (3 - 2 x) / (1 - x)^2, for the default burr; of another it "
          "goes against its section"),
      number<&Settings::point_spacing_mm>(
          "point-spacing", "mm", BoneBricks::kSpacing_mm,
          "How far apart the points of bone lie at most, whatever the scan's voxels; twice as far at the "
          "shaft where the bone is flat"),
      number<&Settings::release_time_s>(
          "release-time", "s", Release{}.time_s,
          "In which a stretch of the coupling that nothing holds any more falls to a third, if not sooner by "
          "the next two"),
      number<&Settings::release_mm_s>(
          "release", "mm/s", Release{}.mm_s,
          "How fast the tool may move beside what the device's own move leads it to"),
      number<&Settings::release_rad_s>("release-turn", "rad/s", Release{}.rad_s, "The same of its turning"),
  };
  return all;
}

}  // namespace

Settings Settings::defaults() {
  return default_settings<Settings>(fields());
}

AlgorithmDescription description() {
  return with_settings<BarrierShell, Settings>(
      {.id = {"barrier-shell", "4 barrier-shell", "#1565c0"},
       .summary = "The tool rests on a soft skin of the bone's points that nothing pushes through",
       .resolution_setting = "point-spacing",
       .resolution_name = "spacing"},
      fields());
}

}  // namespace osteomill::barrier_shell
