#include <vector>

#include "osteomill/haptics/published/surface_points/surface_points.h"
#include "osteomill/haptics/setting_fields.h"
#include "osteomill/tool/sample_points.h"

namespace osteomill::surface_points {

namespace {

using Field = SettingField<Settings>;

const std::vector<Field>& fields() {
  static const std::vector<Field> all{
      setting_field<&Settings::stiffness_N_per_mm>(
          {"stiffness", "N/mm", SettingRange::positive(), 20,
           "k of (14): the spring of a sphere, or of a slice, all of whose vertices collide", "stiffness"}),
      setting_field<&Settings::slices>(
          {"slices", "", SettingRange::count(1, 1000), 20, "Circles along the free shaft", "slices"}),
      setting_field<&Settings::sphere_vertices>(
          {"sphere-vertices", "", SettingRange::count(4, 500), kSphereVertices,
           "Vertices on the burr's sphere: 24 as a snub cube, another number as equal charges spread"}),
      setting_field<&Settings::circle_vertices>({"circle-vertices", "", SettingRange::count(3, 100),
                                                 kSliceVertices, "Vertices on each circle of the shaft"}),
  };
  return all;
}

}  // namespace

Settings Settings::defaults() {
  return default_settings<Settings>(fields());
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
