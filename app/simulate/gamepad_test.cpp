#include "app/simulate/gamepad.h"

#include <gtest/gtest.h>

namespace osteomill::app {
namespace {

TEST(GamepadInput, IsZeroAtRestAndWithinTheDeadZone) {
  GamepadState worn;
  worn.left_stick = {0.14, -0.14};
  worn.right_stick = {-0.1, 0.12};
  worn.left_trigger = -0.8;
  for (const GamepadState& state : {GamepadState{}, worn}) {
    const GamepadInput input = gamepad_input(state, {});
    EXPECT_EQ(input.motion.push, Vec3::Zero());
    EXPECT_EQ(input.motion.twist, Vec3::Zero());
  }
}

// Sticks are positive to the right and down; the viewer's axes point right, up and towards the viewer.
TEST(GamepadInput, PushesAndTwistsAlongTheViewersAxes) {
  GamepadState state;
  state.left_stick = {1, -1};
  state.right_trigger = 1;
  EXPECT_EQ(gamepad_input(state, {}).motion.push, Vec3(1, 1, -1));
  state = {};
  state.left_trigger = 1;
  state.right_stick = {-1, 1};
  state.right_bumper = true;
  EXPECT_EQ(gamepad_input(state, {}).motion.push, Vec3(0, 0, 1));
  EXPECT_EQ(gamepad_input(state, {}).motion.twist, Vec3(1, -1, -0.5));
}

TEST(GamepadInput, IsAQuarterAtHalfTravelBeyondTheDeadZone) {
  GamepadState state;
  state.left_stick = {0.15 + 0.85 / 2, 0};
  EXPECT_DOUBLE_EQ(gamepad_input(state, {}).motion.push.x(), 0.25);
}

TEST(GamepadInput, ReportsEachButtonPressOnce) {
  GamepadState down;
  down.a = down.b = down.x = true;
  const GamepadInput pressed = gamepad_input(down, {});
  EXPECT_TRUE(pressed.is_mill_pressed && pressed.is_release_pressed && pressed.is_undo &&
              !pressed.is_mill_released);
  const GamepadInput held = gamepad_input(down, down);
  EXPECT_FALSE(held.is_mill_pressed || held.is_release_pressed || held.is_undo || held.is_mill_released);
  const GamepadInput released = gamepad_input({}, down);
  EXPECT_TRUE(released.is_mill_released);
  EXPECT_FALSE(released.is_mill_pressed || released.is_release_pressed || released.is_undo);
}

}  // namespace
}  // namespace osteomill::app
