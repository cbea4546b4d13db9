#pragma once

#include "app/simulate/simulation.h"
#include "app/simulate/view_state.h"

#include "osteomill/device/space_mouse.h"

namespace osteomill::app {

/// Takes what mouse, keyboard and SpaceMouse did since the last picture to the camera and the tool, as the
/// help tells.
void take_input(ViewState& view, Simulation& simulation, SpaceMouse& space_mouse, const PixelSize& size);

}  // namespace osteomill::app
