#include <vector>

#include "osteomill/haptics/sample_points.h"
#include "osteomill/haptics/setting_fields.h"

#include "published/surface_points/surface_points.h"

namespace osteomill::surface_points {

namespace {

using Fields = std::vector<Field<Settings>>;

// Range in which all numbers stay finite; poor values within it cause a warning.
constexpr NumberRange kStiffness{0.001, 1e4};

const Fields& fields() {
  static const Fields all{
      field<Settings>({.name = "stiffness",
                       .unit = "N/mm",
                       .range = kStiffness,
                       .doc = "Stiffness with which a sphere or slice is pushed out when all of its vertices "
                              "are in bone; k in (14) of the paper",
                       .option = "stiffness"},
                      &Settings::stiffness_N_per_mm),
      field<Settings>({.name = "slices",
                       .range = NumberRange::count(1, 1000),
                       .doc = "Number of circles along the free shaft",
                       .option = "slices"},
                      &Settings::slices),
      field<Settings>({.name = "sphere-vertices",
                       .range = NumberRange::count(4, 500),
                       .doc = "Number of vertices on the burr's sphere: 24 form a snub cube, other numbers "
                              "are spread like equal charges"},
                      &Settings::sphere_vertices),
      field<Settings>({.name = "circle-vertices",
                       .range = NumberRange::count(3, 100),
                       .doc = "Number of vertices on each circle of the shaft"},
                      &Settings::circle_vertices),
  };
  return all;
}

}  // namespace

AlgorithmDescription description() {
  return with_settings<SurfacePoints, Settings>(
      {.id = {"surface-points", "2 surface-points", "#3fae49"},
       .summary = "A spring pushes each vertex of the tool's surface that is in bone back towards the "
                  "tool's centre; the burr's springs give the force, the shaft's the torque",
       .resolution_setting = "slices",
       .resolution_name = "slices"},
      fields());
}

}  // namespace osteomill::surface_points
