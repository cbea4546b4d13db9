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
  // Name, unit, range, value in paper, in steady, meaning, option.
  static const std::vector<Field> all{
      setting_field<Settings>(
          {"stiffness", "N/mm", SettingRange::positive(), 20, 20,
           "k of (14): the spring of a sphere, or of a slice, all of whose vertices collide", "stiffness"},
          [](Settings & s) -> auto& { return s.stiffness_N_per_mm; }),
      setting_field<Settings>(
          {"slices", "", SettingRange::count(1, 1000), 20, 20,
           "Circles along the free shaft, eight vertices each", "slices"},
          [](Settings & s) -> auto& { return s.slices; }),
      setting_field<Settings>(
          {"march-to-surface", "", SettingRange::on_or_off(), 0, 1,
           "A spring of (15) ends where a walk from the centre to the vertex first meets bone, not where "
           "linear densities would cross the isovalue"},
          [](Settings & s) -> auto& { return s.march_to_surface; }),
      setting_field<Settings>(
          {"thin-walls-hold", "", SettingRange::on_or_off(), 0, 1,
           "With march-to-surface: a vertex counts as soon as bone lies between it and the centre, so that a "
           "thin wall does not let go of the burr"},
          [](Settings & s) -> auto& { return s.thin_walls_hold; }),
      setting_field<Settings>(
          {"shaft-force", "", SettingRange::on_or_off(), 0, 1,
           "The slices' forces, weighted as (20) weights their torques, are felt as force too"},
          [](Settings & s) -> auto& { return s.shaft_force; }),
      setting_field<Settings>(
          {"edge-share", "", SettingRange::share(), 0, 0.1,
           "The share of a mean by force that is added to the mean by number of (20), in which an edge is as "
           "many times too soft as there are slices"},
          [](Settings & s) -> auto& { return s.edge_share; }),
      setting_field<Settings>(
          {"slice-levers", "", SettingRange::on_or_off(), 0, 1,
           "Where on the shaft a slice is pushed follows from its depth a third of the way to the next ones, "
           "in place of its middle"},
          [](Settings & s) -> auto& { return s.slice_levers; }),
      setting_field<Settings>(
          {"hold-tool", "", SettingRange::on_or_off(), 0, 1,
           "In place of (17) and (19): a simulated tool follows the device as far as the bone lets it, and "
           "is what is drawn and what cuts"},
          [](Settings & s) -> auto& { return s.hold_tool; }),
      setting_field<Settings>(
          {"rings-per-slice", "", SettingRange::count(1, 10), 1, 3,
           "How many circles stand for a slice, side by side"},
          [](Settings & s) -> auto& { return s.rings_per_slice; }),
      setting_field<Settings>(
          {"greatest-stiffness", "N/mm", SettingRange::limit(), kInfinity, 3,
           "Where a sphere on a plane would be stiffer than this, the force is made to grow with this "
           "stiffness"},
          [](Settings & s) -> auto& { return s.max_stiffness_N_per_mm; }),
      setting_field<Settings>(
          {"bite", "voxels", SettingRange::not_negative(), 0, 0.3,
           "How deep in bone the burr of the held tool rests, at most 0.2 mm: one that only touches the "
           "surface sticks in its own hole"},
          [](Settings & s) -> auto& { return s.bite_voxels; }),
      setting_field<Settings>(
          {"contact-damping", "s/mm", SettingRange::not_negative(), 0, 0.003,
           "Damping of the sphere's contact in proportion to its force (Hunt and Crossley 1975); needs "
           "hold-tool"},
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
