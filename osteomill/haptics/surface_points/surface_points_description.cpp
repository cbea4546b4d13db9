#include <limits>
#include <vector>

#include "osteomill/haptics/setting_fields.h"
#include "osteomill/haptics/surface_points/surface_points.h"
#include "osteomill/tool/sample_points.h"

namespace osteomill::surface_points {

namespace {

using Field = SettingField<Settings>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

const std::vector<Field>& fields() {
  // Name, unit, range, value in paper, in steady, meaning, option.
  static const std::vector<Field> all{
      setting_field<&Settings::stiffness_N_per_mm>(
          {"stiffness", "N/mm", SettingRange::positive(), 20, 20,
           "k of (14): the spring of a sphere, or of a slice, all of whose vertices collide", "stiffness"}),
      setting_field<&Settings::slices>(
          {"slices", "", SettingRange::count(1, 1000), 20, 20, "Circles along the free shaft", "slices"}),
      setting_field<&Settings::sphere_vertices>(
          {"sphere-vertices", "", SettingRange::count(4, 500), kSphereVertices, kSphereVertices,
           "Vertices on the burr's sphere: 24 as a snub cube, another number as equal charges spread"}),
      setting_field<&Settings::circle_vertices>({"circle-vertices", "", SettingRange::count(3, 100),
                                                 kSliceVertices, kSliceVertices,
                                                 "Vertices on each circle of the shaft"}),
      setting_field<&Settings::reach>(
          {"spring-reach", "", SettingRange::count(0, 2), 1, 2,
           "a_i of (15): 0 as printed, the fraction measured from the centre; 1 to where linear densities "
           "would cross the isovalue; 2 to where a walk from the centre first meets bone"}),
      setting_field<&Settings::hold_tool>(
          {"hold-tool", "", SettingRange::on_or_off(), 0, 1,
           "In place of (17) and (19): a simulated tool follows the device as far as the bone lets it, is "
           "felt by a damped spring beside the vertices', and is what is drawn and what cuts"}),
      setting_field<&Settings::shaft_force>({"shaft-force", "", SettingRange::on_or_off(), 0, 1,
                                             "The slices' forces are felt too, not their torque alone"}),
      setting_field<&Settings::max_stiffness_N_per_mm>(
          {"greatest-stiffness", "N/mm", SettingRange::limit(), kInfinity, 3,
           "Where a sphere on a plane would be stiffer than this, the force is made to grow with this "
           "stiffness"}),
  };
  return all;
}

}  // namespace

Settings Settings::defaults(Mode mode) {
  return settings_in<Settings>(mode, fields());
}

AlgorithmDescription description() {
  return with_settings<SurfacePoints, Settings>(
      {.id = {"surface-points", "2 surface-points", "#3fae49"},
       .summary =
           "Vertices on the tool's surface, each a spring towards its centre, sent straight to the hand",
       .resolution_setting = "slices",
       .resolution_name = "slices"},
      fields());
}

}  // namespace osteomill::surface_points
