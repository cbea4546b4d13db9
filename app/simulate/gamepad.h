#pragma once

#include <array>

#include "osteomill/session/space_mouse.h"

namespace osteomill::app {

/// State of a game controller, named as in GLFW.
struct GamepadState {
  /// -1 to 1; positive to the right and down.
  std::array<double, 2> left_stick{}, right_stick{};
  /// -1 (released) to 1 (pressed).
  double left_trigger = -1, right_trigger = -1;
  bool left_bumper = false, right_bumper = false;
  /// Lower, right and left of the four face buttons.
  bool a = false, b = false, x = false;
};

/// Commands from a game controller.
struct GamepadInput {
  /// The left stick moves in the view plane, the right trigger presses in and the left one pulls back; the
  /// right stick turns, and the bumpers turn about the line of sight.
  SpaceMouseState motion;
  /// Press and release of the milling button.
  bool is_mill_pressed = false, is_mill_released = false;
  bool is_release_pressed = false;
  bool is_undo = false;
};

/// Returns the commands of a controller; `before` is its state in the previous frame.
GamepadInput gamepad_input(const GamepadState& now, const GamepadState& before);

/// The first connected game controller, if any. For the window's thread.
class Gamepad {
 public:
  /// Reads the controller; call once per frame. Never waits.
  GamepadInput read();

 private:
  GamepadState before_;
};

}  // namespace osteomill::app
