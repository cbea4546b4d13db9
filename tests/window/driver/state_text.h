#pragma once

#include <string>

#include "app/simulate/window_driver.h"

namespace osteomill::app {

/// Returns a line "NAME.KEY=VALUE" for everything that the window's controls bring about: not how a control
/// stands, but what is in force, is drawn and is heard. A scan is open.
std::string state_text(const std::string& name, const WindowContents& window);

/// Returns the line "NAME.colour=RED GREEN BLUE" for the pixel at the burr's middle. A scan is open.
std::string colour_text(const std::string& name, const WindowContents& window);

}  // namespace osteomill::app
