#pragma once

#include "app/simulate/simulation.h"
#include "app/simulate/view_state.h"

namespace osteomill::app {

/// Takes what mouse and keyboard did since the last picture to the camera and the tool, as the help tells.
void take_input(ViewState& view, Simulation& simulation, const PixelSize& size);

}  // namespace osteomill::app
