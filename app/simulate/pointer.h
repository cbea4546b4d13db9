#pragma once

#include "app/simulate/simulation.h"
#include "app/simulate/view_state.h"

#include "osteomill/device/space_mouse.h"

namespace osteomill::app {

/// Takes what mouse, keyboard and SpaceMouse did since the last picture to the camera and the tool, as the
/// help tells.
void take_input(ViewState& view, Simulation& simulation, SpaceMouse& space_mouse, const PixelSize& size);

/// Where bone came back (a cut undone, another isovalue) or the tool grew while it was in a hole: brings it
/// out, before the bone where it is seen. Does nothing to a tool that only presses on bone.
void free_tool(ViewState& view, Simulation& simulation, const PixelSize& size);

}  // namespace osteomill::app
