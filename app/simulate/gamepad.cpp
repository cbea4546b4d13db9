#include "app/simulate/gamepad.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <GLFW/glfw3.h>

namespace osteomill::app {

namespace {

// Resting offset of worn sticks.
constexpr double kDeadZone = 0.15;

// Quadratic from the edge of the dead zone, for fine control of small motions.
double eased(double axis) {
  const double beyond = std::clamp((std::abs(axis) - kDeadZone) / (1 - kDeadZone), 0.0, 1.0);
  return std::copysign(beyond * beyond, axis);
}

double pulled(double trigger) {
  return eased(0.5 * (trigger + 1));
}

}  // namespace

GamepadInput gamepad_input(const GamepadState& now, const GamepadState& before) {
  GamepadInput input;
  input.motion.push = {eased(now.left_stick[0]), -eased(now.left_stick[1]),
                       pulled(now.left_trigger) - pulled(now.right_trigger)};
  input.motion.twist = {eased(now.right_stick[1]), eased(now.right_stick[0]),
                        (now.left_bumper ? 0.5 : 0.0) - (now.right_bumper ? 0.5 : 0.0)};
  input.is_mill_pressed = now.a && !before.a;
  input.is_mill_released = before.a && !now.a;
  input.is_release_pressed = now.b && !before.b;
  input.is_undo = now.x && !before.x;
  return input;
}

GamepadInput Gamepad::read() {
  GamepadState now;
  for (int n = GLFW_JOYSTICK_1; n <= GLFW_JOYSTICK_LAST; ++n) {
    GLFWgamepadstate state;
    if (glfwGetGamepadState(n, &state) == GLFW_FALSE) continue;
    const auto axis = [&](int which) { return static_cast<double>(state.axes[which]); };
    const auto is_down = [&](int which) { return state.buttons[which] == GLFW_PRESS; };
    now.left_stick = {axis(GLFW_GAMEPAD_AXIS_LEFT_X), axis(GLFW_GAMEPAD_AXIS_LEFT_Y)};
    now.right_stick = {axis(GLFW_GAMEPAD_AXIS_RIGHT_X), axis(GLFW_GAMEPAD_AXIS_RIGHT_Y)};
    now.left_trigger = axis(GLFW_GAMEPAD_AXIS_LEFT_TRIGGER);
    now.right_trigger = axis(GLFW_GAMEPAD_AXIS_RIGHT_TRIGGER);
    now.left_bumper = is_down(GLFW_GAMEPAD_BUTTON_LEFT_BUMPER);
    now.right_bumper = is_down(GLFW_GAMEPAD_BUTTON_RIGHT_BUMPER);
    now.a = is_down(GLFW_GAMEPAD_BUTTON_A);
    now.b = is_down(GLFW_GAMEPAD_BUTTON_B);
    now.x = is_down(GLFW_GAMEPAD_BUTTON_X);
    break;
  }
  return gamepad_input(now, std::exchange(before_, now));
}

}  // namespace osteomill::app
