#pragma once

#include <string>

#include "app/simulate/window_driver.h"

namespace osteomill::app {

/// Returns a line "NAME.KEY=VALUE" for every effect of the window's controls: not the control's own value,
/// but the state in force, drawn or heard. Requires an open scan.
std::string state_text(const std::string& name, const WindowContents& window);

/// Returns the line "NAME.colour=RED GREEN BLUE" for the pixel at the burr's centre. Requires an open scan.
std::string colour_text(const std::string& name, const WindowContents& window);

}  // namespace osteomill::app
