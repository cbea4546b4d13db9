// Replaces a game controller; preloaded before GLFW. The file named in OSTEOMILL_GAMEPAD contains six axes
// and the states of the buttons A, B and X.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <GLFW/glfw3.h>

int glfwGetGamepadState(int joystick, GLFWgamepadstate* state) {
  memset(state, 0, sizeof *state);
  FILE* const file = joystick == GLFW_JOYSTICK_3 ? fopen(getenv("OSTEOMILL_GAMEPAD"), "r") : NULL;
  if (file == NULL) return GLFW_FALSE;
  int a = 0, b = 0, x = 0, read = 0;
  for (int n = 0; n < 6; ++n) read += fscanf(file, "%f", &state->axes[n]);
  read += fscanf(file, "%d %d %d", &a, &b, &x);
  fclose(file);
  state->buttons[GLFW_GAMEPAD_BUTTON_A] = (unsigned char)a;
  state->buttons[GLFW_GAMEPAD_BUTTON_B] = (unsigned char)b;
  state->buttons[GLFW_GAMEPAD_BUTTON_X] = (unsigned char)x;
  return read == 9 ? GLFW_TRUE : GLFW_FALSE;
}
