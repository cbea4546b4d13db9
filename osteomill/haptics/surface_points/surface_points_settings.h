#pragma once

#include <limits>

#include "osteomill/haptics/algorithm_id.h"

namespace osteomill {

/// Settings of algorithm 2, `surface-points` (Eriksson 2012, section 5). The members from `march_to_surface`
/// on are the improvements of `steady`; each may be switched on by itself, and `paper` has none of them.
struct SurfacePointsSettings {
  /// k of (14): the spring of a sphere, or of a slice, all of whose vertices collide.
  double stiffness_N_per_mm = 20.0;
  /// Circles along the free shaft, eight vertices each.
  int slices = 20;

  /// A spring of (15) ends where a walk from the centre to the vertex first meets bone, not where the
  /// density, taken to be linear between the two, would cross the isovalue.
  bool march_to_surface = false;
  /// With `march_to_surface`: a vertex of the sphere counts as soon as bone lies between it and the centre,
  /// also where the vertex itself has come out on the other side. Without it a thin wall lets go of the burr.
  bool thin_walls_hold = false;
  /// The slices' forces, weighted by 1/slices as (20) weights their torques, are felt as force too.
  bool shaft_force = false;
  /// The mean of (20), each slice by 1/slices, makes a shaft that lies on an edge as many times softer than
  /// one that lies flat as there are slices. This share of another mean, each slice by its own force, is
  /// added.
  double edge_share = 0.0;
  /// Where on the shaft a slice is pushed, by its depth a third of the way to the next ones, in place of its
  /// middle.
  bool slice_levers = false;
  /// In place of (17) and (19), with nothing kept from an earlier step: a simulated tool follows the device
  /// as far as the bone lets it (held_tool.h). A sphere or slice whose centre cannot go straight from there
  /// to the device's is rendered where bone stops it, and a spring as stiff as the contact there (k/2, see
  /// `greatest_stiffness_N_per_mm`) is added from the device's centre to that place: the force grows as long
  /// as the hand pushes. The simulated tool is what is drawn and what cuts.
  bool hold_tool = false;
  /// How many circles stand for a slice, side by side (1 is the paper's): with one, an edge between two
  /// slices 1.2 mm apart is not felt, and its lever is known to half of that.
  int rings_per_slice = 1;
  /// The force on the sphere grows with the square of the depth, so the contact gets stiffer as the hand
  /// pushes harder, until no device is stable. Where a sphere on a plane would be stiffer than this, the
  /// force is made to grow with this stiffness. Infinite: never.
  double greatest_stiffness_N_per_mm = std::numeric_limits<double>::infinity();

  /// How deep in bone, in voxels of the least spacing and at most `kGreatestBite_mm`, the burr of the held
  /// tool rests: bone that is denser than the isovalue lies up to a voxel behind the surface, and a burr that
  /// only touches the surface would not reach it and would stick in its own hole.
  double bite_voxels = 0.0;
  static constexpr double kGreatestBite_mm = 0.2;
  /// Damping of the sphere's contact as Hunt and Crossley (1975) have it: the force is multiplied by 1 plus
  /// this times the speed (mm/s) at which the device sinks away from the held tool, so that it still begins
  /// at zero. At force F it is a damper of F times this, in N s/mm. Needs `hold_tool`.
  double contact_damping_s_per_mm = 0.0;

  static SurfacePointsSettings defaults(Mode mode);
};

/// Throws std::invalid_argument, naming the setting, where one is out of range.
void require_valid(const SurfacePointsSettings& settings);

}  // namespace osteomill
