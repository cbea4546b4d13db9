/* The UDP example with a hand that sinks at 2 mm/s from the first wrench on, so that it soon presses on the bone. */
#define OWN_DEVICE
#include "../../examples/udp_device.c"

static void describe(struct reply *reply) {
  strcpy(reply->name, "sinking device");
  reply->sensed = reply->driven = 6;
  reply->max_force_N = 10;
  reply->max_torque_Nmm = 200;
}

static int read_handle(double time_s, struct state *state) {
  state->position_mm[1] = -2 * time_s;
  state->orientation_wxyz[0] = 1;
  state->buttons = 1;
  state->not_driven = 0;
  return 1;
}

static void drive_motors(const double force_N[3], const double torque_Nmm[3]) {
  (void)force_N;
  (void)torque_Nmm;
}
