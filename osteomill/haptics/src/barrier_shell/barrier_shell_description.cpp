#include <vector>

#include "osteomill/haptics/setting_fields.h"

#include "barrier_shell/barrier_shell.h"
#include "tool_move.h"

namespace osteomill::barrier_shell {

namespace {

using Fields = std::vector<Field<Settings>>;

// Ranges in which a tool is held and a tick's work is bounded (session/setting_ranges_test.cpp).
constexpr NumberRange kStiffness{0.05, 200}, kTorsion{1, 1e5}, kSkin{0.05, 1}, kRounding{0.02, 0.3},
    kPressure{0.05, 100}, kSpacing{0.03, 0.5}, kReleaseTime{0.001, 1000}, kReleaseSpeed{0.1, 1e4},
    kReleaseTurn{0.001, 100};

const Fields& fields() {
  static const Fields all{
      field<Settings>(coupling_stiffness(kStiffness), &Settings::translational_stiffness_N_per_mm),
      field<Settings>(coupling_torsion(kTorsion), &Settings::torsional_stiffness_Nmm_per_rad),
      field<Settings>(
          {"skin-width", "mm", kSkin,
           "Distance from the tool's cores at which bone is felt; reduced in proportion if the rounding is"},
          &Settings::skin_width_mm),
      field<Settings>({"rounding", "mm", kRounding,
                       "Depth of the cores below the tool's surface; reduced to at most half of the tool's "
                       "smallest radius"},
                      &Settings::rounding_mm),
      field<Settings>({"pressure", "N/mm2", kPressure,
                       "p0 in the skin's pressure p0 / 3 x^2 (3 - 2 x) / (1 - x)^2 for the default burr; "
                       "scaled inversely with the cross-section for other burrs"},
                      &Settings::pressure_N_per_mm2),
      field<Settings>({"point-spacing", "mm", kSpacing,
                       "Largest distance between the bone's points, regardless of the scan's voxel size; "
                       "smaller for a thin tool, doubled at a thick shaft on flat bone"},
                      &Settings::point_spacing_mm),
      field<Settings>({"release-time", "s", kReleaseTime,
                       "Time in which the coupling's stretch falls to a third once contact no longer holds "
                       "it, unless release and release-turn are faster"},
                      &Settings::release_time_s),
      field<Settings>({"release", "mm/s", kReleaseSpeed,
                       "Speed limit of the tool's translation beyond the device's own motion"},
                      &Settings::release_mm_s),
      field<Settings>({"release-turn", "rad/s", kReleaseTurn,
                       "Speed limit of the tool's rotation beyond the device's own motion"},
                      &Settings::release_rad_s),
  };
  return all;
}

}  // namespace

AlgorithmDescription description() {
  return with_settings<BarrierShell, Settings>(
      {.id = {"barrier-shell", "4 barrier-shell", "#1565c0"},
       .summary = "The tool rests on a soft skin around the bone's points; no force pushes it through",
       .resolution_setting = "point-spacing",
       .resolution_name = "spacing",
       .has_guards = true},
      fields());
}

}  // namespace osteomill::barrier_shell
