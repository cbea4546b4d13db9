#include <vector>

#include "osteomill/haptics/setting_fields.h"

#include "barrier_shell/barrier_shell.h"
#include "tool_move.h"

namespace osteomill::barrier_shell {

namespace {

using Fields = std::vector<Field<Settings>>;

// Within these a tool is held, and a tick's work is bounded (session/setting_ranges_test.cpp).
constexpr NumberRange kStiffness{0.05, 200}, kTorsion{1, 1e5}, kSkin{0.05, 1}, kRounding{0.02, 0.3},
    kPressure{0.05, 100}, kSpacing{0.03, 0.5}, kReleaseTime{0.001, 1000}, kReleaseSpeed{0.1, 1e4},
    kReleaseTurn{0.001, 100};

const Fields& fields() {
  static const Fields all{
      field<Settings>({"translational-stiffness", "N/mm", kStiffness,
                       "Virtual coupling between device and simulated tool", 0, "stiffness"},
                      &Settings::translational_stiffness_N_per_mm),
      field<Settings>({"torsional-stiffness", "N mm/rad", kTorsion, "Of the coupling, about rotation", 0,
                       "torsional-stiffness"},
                      &Settings::torsional_stiffness_Nmm_per_rad),
      field<Settings>({"skin-width", "mm", kSkin,
                       "How far from the tool's cores bone is felt; less where the rounding is less"},
                      &Settings::skin_width_mm),
      field<Settings>({"rounding", "mm", kRounding,
                       "How far the cores lie within the tool, at most half of its least radius"},
                      &Settings::rounding_mm),
      field<Settings>(
          {"pressure", "N/mm2", kPressure,
           "p0 of the skin's pressure p0 / 3 x^2 (3 - 2 x) / (1 - x)^2, for the default burr; of another it "
           "goes against its section"},
          &Settings::pressure_N_per_mm2),
      field<Settings>(
          {"point-spacing", "mm", kSpacing,
           "How far apart the points of bone lie at most, whatever the scan's voxels; less for a thin tool, "
           "and twice as far at a thick shaft where the bone is flat"},
          &Settings::point_spacing_mm),
      field<Settings>({"release-time", "s", kReleaseTime,
                       "In which a stretch of the coupling that nothing holds any more falls to a third, if "
                       "not sooner by "
                       "the next two"},
                      &Settings::release_time_s),
      field<Settings>({"release", "mm/s", kReleaseSpeed,
                       "How fast the tool may move beside what the device's own move leads it to"},
                      &Settings::release_mm_s),
      field<Settings>({"release-turn", "rad/s", kReleaseTurn, "The same of its turning"},
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
