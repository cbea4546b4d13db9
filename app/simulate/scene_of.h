#pragma once

#include "app/simulate/simulation.h"
#include "app/simulate/view_state.h"

namespace osteomill::app {

/// What is to be drawn now.
ViewScene scene_of(const ViewState& view, Simulation& simulation);

}  // namespace osteomill::app
