#pragma once

#include "osteomill/haptics/mode.h"

namespace osteomill::surface_points {

/// What algorithm 2 is made of; surface_points_description.cpp says of each setting what it means, its range
/// and its value in either mode.
struct Settings {
  double stiffness_N_per_mm = 0;
  int slices = 0;
  bool march_to_surface = false;
  bool thin_walls_hold = false;
  bool shaft_force = false;
  double edge_share = 0;
  bool slice_levers = false;
  bool hold_tool = false;
  int rings_per_slice = 0;
  double max_stiffness_N_per_mm = 0;
  /// In voxels of the smallest spacing, and at most `kMaxBite_mm`: bone that is denser than the isovalue lies
  /// up to a voxel behind the surface.
  double bite_voxels = 0;
  static constexpr double kMaxBite_mm = 0.2;
  double contact_damping_s_per_mm = 0;

  static Settings defaults(Mode mode);
};

/// Throws std::invalid_argument, naming the setting, where one is out of range.
void require_valid(const Settings& settings);

}  // namespace osteomill::surface_points
