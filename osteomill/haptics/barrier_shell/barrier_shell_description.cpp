#include <vector>

#include "osteomill/haptics/barrier_shell/barrier_shell.h"
#include "osteomill/haptics/setting_fields.h"
#include "osteomill/haptics/tool_move.h"

namespace osteomill::barrier_shell {

namespace {

using Fields = std::vector<Field<Settings>>;

const Fields& fields() {
  static const Fields all{
      field<Settings>({"translational-stiffness", "N/mm", NumberRange::positive(),
                       "Virtual coupling between device and simulated tool", 0, "stiffness"},
                      &Settings::translational_stiffness_N_per_mm),
      field<Settings>({"torsional-stiffness", "N mm/rad", NumberRange::positive(),
                       "Of the coupling, about rotation", 0, "torsional-stiffness"},
                      &Settings::torsional_stiffness_Nmm_per_rad),
      field<Settings>({"skin-width", "mm", NumberRange::positive(),
                       "How far from the tool's cores bone is felt; less where the rounding is less"},
                      &Settings::skin_width_mm),
      field<Settings>({"rounding", "mm", NumberRange::positive(),
                       "How far the cores lie within the tool, at most half of its least radius"},
                      &Settings::rounding_mm),
      field<Settings>(
          {"pressure", "N/mm2", NumberRange::positive(),
           "p0 of the skin's pressure p0 / 3 x^2 (3 - 2 x) / (1 - x)^2, for the default burr; of another it "
           "goes against its section"},
          &Settings::pressure_N_per_mm2),
      field<Settings>(
          {"point-spacing", "mm", NumberRange::positive(),
           "How far apart the points of bone lie at most, whatever the scan's voxels; twice as far at the "
           "shaft where the bone is flat"},
          &Settings::point_spacing_mm),
      field<Settings>({"release-time", "s", NumberRange::positive(),
                       "In which a stretch of the coupling that nothing holds any more falls to a third, if "
                       "not sooner by "
                       "the next two"},
                      &Settings::release_time_s),
      field<Settings>({"release", "mm/s", NumberRange::positive(),
                       "How fast the tool may move beside what the device's own move leads it to"},
                      &Settings::release_mm_s),
      field<Settings>({"release-turn", "rad/s", NumberRange::positive(), "The same of its turning"},
                      &Settings::release_rad_s),
  };
  return all;
}

}  // namespace

AlgorithmDescription description() {
  return with_settings<BarrierShell, Settings>(
      {.id = {"barrier-shell", "4 barrier-shell", "#1565c0"},
       .summary = "The tool rests on a soft skin of the bone's points that nothing pushes through",
       .resolution_setting = "point-spacing",
       .resolution_name = "spacing"},
      fields());
}

}  // namespace osteomill::barrier_shell
