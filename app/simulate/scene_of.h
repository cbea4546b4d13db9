#pragma once

#include "app/simulate/simulation.h"
#include "app/simulate/view_state.h"

namespace osteomill::app {

/// A sphere about all bone of the grid (about the grid where there is none).
Sphere bounds_of_bone(const DensityGrid& grid, double isovalue);

/// The camera from obliquely above the entry, close enough to mill: all of a small bone, the surroundings of
/// the entry of a large one.
Camera camera_on_entry(const MillingEntry& entry, const Sphere& bounds);

/// What is to be drawn now.
ViewScene scene_of(const ViewState& view, Simulation& simulation);

}  // namespace osteomill::app
