#include "osteomill/haptics/surface_points/surface_points_description.h"

#include <limits>
#include <vector>

#include "osteomill/haptics/setting_fields.h"
#include "osteomill/haptics/surface_points/surface_points.h"
#include "osteomill/haptics/surface_points/surface_points_settings.h"

namespace osteomill::surface_points {

namespace {

using Field = SettingField<Settings>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

const AlgorithmId& id() {
  static const AlgorithmId self{"surface-points", "2 surface-points", "#3fae49"};
  return self;
}

const std::vector<Field>& fields() {
  static const std::vector<Field> all{
      setting_field<Settings>(
          {.name = "stiffness",
           .unit = "N/mm",
           .range = SettingRange::positive(),
           .paper = 20,
           .steady = 20,
           .meaning = "k of (14): the spring of a sphere, or of a slice, all of whose vertices collide",
           .option = "stiffness"},
          [](Settings & s) -> auto& { return s.stiffness_N_per_mm; }),
      setting_field<Settings>(
          {.name = "slices",
           .unit = "",
           .range = SettingRange::count(1, 1000),
           .paper = 20,
           .steady = 20,
           .meaning = "Circles along the free shaft, eight vertices each",
           .option = "slices"},
          [](Settings & s) -> auto& { return s.slices; }),
      setting_field<Settings>(
          {.name = "march-to-surface",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "A spring of (15) ends where a walk from the centre to the vertex first meets bone, "
                      "not where linear densities would cross the isovalue"},
          [](Settings & s) -> auto& { return s.march_to_surface; }),
      setting_field<Settings>(
          {.name = "thin-walls-hold",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "With march-to-surface: a vertex counts as soon as bone lies between it and the "
                      "centre, so that a thin wall does not let go of the burr"},
          [](Settings & s) -> auto& { return s.thin_walls_hold; }),
      setting_field<Settings>(
          {.name = "shaft-force",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "The slices' forces, weighted as (20) weights their torques, are felt as force too"},
          [](Settings & s) -> auto& { return s.shaft_force; }),
      setting_field<Settings>(
          {.name = "edge-share",
           .unit = "",
           .range = SettingRange::share(),
           .paper = 0,
           .steady = 0.1,
           .meaning = "The share of a mean by force that is added to the mean by number of (20), in which an "
                      "edge is as many times too soft as there are slices"},
          [](Settings & s) -> auto& { return s.edge_share; }),
      setting_field<Settings>(
          {.name = "slice-levers",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "Where on the shaft a slice is pushed follows from its depth a third of the way to the "
                      "next ones, in place of its middle"},
          [](Settings & s) -> auto& { return s.slice_levers; }),
      setting_field<Settings>(
          {.name = "hold-tool",
           .unit = "",
           .range = SettingRange::on_or_off(),
           .paper = 0,
           .steady = 1,
           .meaning = "In place of (17) and (19): a simulated tool follows the device as far as the bone "
                      "lets it, and is what is drawn and what cuts"},
          [](Settings & s) -> auto& { return s.hold_tool; }),
      setting_field<Settings>(
          {.name = "rings-per-slice",
           .unit = "",
           .range = SettingRange::count(1, 10),
           .paper = 1,
           .steady = 3,
           .meaning = "How many circles stand for a slice, side by side"},
          [](Settings & s) -> auto& { return s.rings_per_slice; }),
      setting_field<Settings>(
          {.name = "greatest-stiffness",
           .unit = "N/mm",
           .range = SettingRange::limit(),
           .paper = kInfinity,
           .steady = 3,
           .meaning = "Where a sphere on a plane would be stiffer than this, the force is made to grow with "
                      "this stiffness"},
          [](Settings & s) -> auto& { return s.max_stiffness_N_per_mm; }),
      setting_field<Settings>(
          {.name = "bite",
           .unit = "voxels",
           .range = SettingRange::not_negative(),
           .paper = 0,
           .steady = 0.3,
           .meaning = "How deep in bone the burr of the held tool rests, at most 0.2 mm: one that only "
                      "touches the surface sticks in its own hole"},
          [](Settings & s) -> auto& { return s.bite_voxels; }),
      setting_field<Settings>(
          {.name = "contact-damping",
           .unit = "s/mm",
           .range = SettingRange::not_negative(),
           .paper = 0,
           .steady = 0.003,
           .meaning = "Damping of the sphere's contact in proportion to its force (Hunt and Crossley 1975); "
                      "needs hold-tool"},
          [](Settings & s) -> auto& { return s.contact_damping_s_per_mm; }),
  };
  return all;
}

}  // namespace

Settings Settings::defaults(Mode mode) {
  return settings_in<Settings>(mode, fields());
}

void require_valid(const Settings& settings) {
  require_in_range<Settings>(id(), settings, fields());
}

AlgorithmDescription description() {
  return with_settings<SurfacePoints, Settings>(
      {.id = id(),
       .summary =
           "Vertices on the tool's surface, each a spring towards its centre, sent straight to the hand",
       .resolution_setting = "slices",
       .resolution_name = "slices",
       .settings = {},
       .make = {}},
      fields());
}

}  // namespace osteomill::surface_points
