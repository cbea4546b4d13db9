/* Connects any device that CHAI3D supports to osteomill; docs/bridges.md explains the build against CHAI3D's
 * source tree.
 *
 *     ./chai3d_bridge [PORT [LOG]]       CHAI3D_DEVICE=1 selects the second device
 *
 * Calibrates the device through CHAI3D; a device that calibrates itself moves, so keep clear of it. */
#define OWN_DEVICE
#include "devices/CHapticDeviceHandler.h"
#include "math/CQuaternion.h"
#include "udp_device.c"

using namespace chai3d;

static cHapticDeviceHandler handler;
static cGenericHapticDevicePtr device;
static int not_driven = 1;

static void describe(struct answer* answer) {
  const char* const number = getenv("CHAI3D_DEVICE");
  if (!handler.getDevice(device, number != nullptr ? atoi(number) : 0) || !device->open()) {
    fprintf(stderr, "chai3d_bridge: CHAI3D finds no device\n");
    exit(1);
  }
  not_driven = device->calibrate() ? 0 : 1;
  const cHapticDeviceInfo can = device->getSpecifications();
  snprintf(answer->name, sizeof answer->name, "%s %s", can.m_manufacturerName.c_str(),
           can.m_modelName.c_str());
  answer->sensed = can.m_sensedRotation ? 6 : 3;
  answer->driven = can.m_actuatedRotation ? 6 : 3;
  answer->max_force_N = can.m_maxLinearForce;
  answer->max_torque_Nmm = 1e3 * can.m_maxAngularTorque;
}

/* CHAI3D uses x towards the operator, y to the right, z up; m and N m. */
static int read_handle(double, struct state* state) {
  cVector3d place_m;
  cMatrix3d turn;
  unsigned int buttons = 0;
  if (!device->getPosition(place_m) || !device->getRotation(turn)) return 0;
  device->getUserSwitches(buttons);
  const double place_mm[3] = {1e3 * place_m.y(), 1e3 * place_m.z(), 1e3 * place_m.x()};
  memcpy(state->position_mm, place_mm, sizeof place_mm);
  cQuaternion q;
  q.fromRotMat(turn);
  q.normalize();
  const double turn_wxyz[4] = {q.w, q.y, q.z, q.x};
  memcpy(state->orientation_wxyz, turn_wxyz, sizeof turn_wxyz);
  state->buttons = buttons;
  state->not_driven = not_driven;
  return 1;
}

static void drive_motors(const double force_N[3], const double torque_Nmm[3]) {
  /* CHAI3D would switch the force on at the first call. */
  if (not_driven) return;
  device->setForceAndTorqueAndGripperForce(cVector3d(force_N[2], force_N[0], force_N[1]),
                                           1e-3 * cVector3d(torque_Nmm[2], torque_Nmm[0], torque_Nmm[1]),
                                           0.0);
}
