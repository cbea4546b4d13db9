#pragma once

#include <array>

#include "osteomill/session/space_mouse.h"

namespace osteomill::app {

/// A game controller as GLFW's table of controllers names its parts.
struct GamepadState {
  /// -1 to 1: to the right and down.
  std::array<double, 2> left_stick{}, right_stick{};
  /// -1 (released) to 1.
  double left_trigger = -1, right_trigger = -1;
  bool left_bumper = false, right_bumper = false;
  /// The lower, the right and the left one of its four buttons.
  bool a = false, b = false, x = false;
};

/// A wish of the hand on a controller.
struct GamepadInput {
  /// The left stick moves across the view, the right trigger presses in and the left one pulls back; the
  /// right stick turns, and the bumpers turn about the line of sight.
  SpaceMouseState motion;
  /// The button that mills went down, or up again.
  bool is_mill_pressed = false, is_mill_released = false;
  bool is_let_go = false;
  bool is_undo = false;
};

/// Returns what a controller asks for now; `before` is its state in the picture before.
GamepadInput gamepad_input(const GamepadState& now, const GamepadState& before);

/// The first game controller that is plugged in, if any. For the window's thread.
class Gamepad {
 public:
  /// Reads it; call once for each picture. Never waits.
  GamepadInput read();

 private:
  GamepadState before_;
};

}  // namespace osteomill::app
