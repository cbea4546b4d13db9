#pragma once

#include "osteomill/haptics/algorithm_description.h"
#include "osteomill/haptics/mode.h"

namespace osteomill::surface_points {

/// How far a vertex in bone is pulled towards its centre, a_i of (15): by a fraction that is measured from
/// the centre, as printed; to where linear densities would cross the isovalue; to where a walk from the
/// centre first meets bone, which sees thin walls too.
enum class Reach : unsigned char { as_printed, to_surface, to_first_bone };

/// What algorithm 2 is made of; surface_points_description.cpp says of each setting what it means, its range
/// and its value in either mode.
struct Settings {
  double stiffness_N_per_mm = 0;
  int slices = 0;
  int sphere_vertices = 0;
  int circle_vertices = 0;
  Reach reach = Reach::to_surface;
  bool hold_tool = false;
  bool shaft_force = false;
  double max_stiffness_N_per_mm = 0;

  static Settings defaults(Mode mode);
};

/// Throws std::invalid_argument, naming the setting, where one is out of range.
void require_valid(const Settings& settings);

/// Algorithm 2 of the paper (section 5).
AlgorithmDescription description();

}  // namespace osteomill::surface_points
