#include "osteomill/recording/record_columns.h"

#include <array>

namespace osteomill {

namespace {

using enum ColumnType;

constexpr const char* kDevicePosition =
    "device as read (X_WD), as the burr's centre, frame W; not finite without a pose";
constexpr const char* kDeviceTurn = "device's orientation in W, unit quaternion";
constexpr const char* kToolPosition = "simulated tool (X_WT), the burr's centre, frame W";
constexpr const char* kToolTurn =
    "simulated tool's orientation in W, unit quaternion; the shaft points along its +z";
constexpr const char* kForce = "force sent to the hand, frame W";
constexpr const char* kTorque = "torque sent to the hand, frame W, about the burr's centre";
constexpr const char* kBurrForce = "force of the burr on the bone, frame W";
constexpr const char* kCuttingTorque =
    "of the torque sent, what the cutting adds (--cutting-reaction), frame W";

#define OSTEOMILL_FIELD(field) \
  [](const TickRecord& r) -> double { return r.field; }, [](TickRecord& r, double value) { r.field = value; }

#define OSTEOMILL_FLAG(field)                                    \
  [](const TickRecord& r) -> double { return r.field ? 1 : 0; }, \
      [](TickRecord& r, double value) { r.field = value != 0; }

constexpr std::array kColumns{
    RecordColumn{"time_s", "s", "when the tick began", real, true, OSTEOMILL_FIELD(time_s)},
    RecordColumn{"device_x_mm", "mm", kDevicePosition, real, true, OSTEOMILL_FIELD(X_WD.position_mm.x())},
    RecordColumn{"device_y_mm", "mm", kDevicePosition, real, true, OSTEOMILL_FIELD(X_WD.position_mm.y())},
    RecordColumn{"device_z_mm", "mm", kDevicePosition, real, true, OSTEOMILL_FIELD(X_WD.position_mm.z())},
    RecordColumn{"device_qw", "", kDeviceTurn, real, true, OSTEOMILL_FIELD(X_WD.orientation.w())},
    RecordColumn{"device_qx", "", kDeviceTurn, real, true, OSTEOMILL_FIELD(X_WD.orientation.x())},
    RecordColumn{"device_qy", "", kDeviceTurn, real, true, OSTEOMILL_FIELD(X_WD.orientation.y())},
    RecordColumn{"device_qz", "", kDeviceTurn, real, true, OSTEOMILL_FIELD(X_WD.orientation.z())},
    RecordColumn{"tool_x_mm", "mm", kToolPosition, real, true, OSTEOMILL_FIELD(X_WT.position_mm.x())},
    RecordColumn{"tool_y_mm", "mm", kToolPosition, real, true, OSTEOMILL_FIELD(X_WT.position_mm.y())},
    RecordColumn{"tool_z_mm", "mm", kToolPosition, real, true, OSTEOMILL_FIELD(X_WT.position_mm.z())},
    RecordColumn{"tool_qw", "", kToolTurn, real, true, OSTEOMILL_FIELD(X_WT.orientation.w())},
    RecordColumn{"tool_qx", "", kToolTurn, real, true, OSTEOMILL_FIELD(X_WT.orientation.x())},
    RecordColumn{"tool_qy", "", kToolTurn, real, true, OSTEOMILL_FIELD(X_WT.orientation.y())},
    RecordColumn{"tool_qz", "", kToolTurn, real, true, OSTEOMILL_FIELD(X_WT.orientation.z())},
    RecordColumn{"force_x_N", "N", kForce, real, true, OSTEOMILL_FIELD(wrench.force_N.x())},
    RecordColumn{"force_y_N", "N", kForce, real, true, OSTEOMILL_FIELD(wrench.force_N.y())},
    RecordColumn{"force_z_N", "N", kForce, real, true, OSTEOMILL_FIELD(wrench.force_N.z())},
    RecordColumn{"torque_x_Nmm", "N mm", kTorque, real, true, OSTEOMILL_FIELD(wrench.torque_Nmm.x())},
    RecordColumn{"torque_y_Nmm", "N mm", kTorque, real, true, OSTEOMILL_FIELD(wrench.torque_Nmm.y())},
    RecordColumn{"torque_z_Nmm", "N mm", kTorque, real, true, OSTEOMILL_FIELD(wrench.torque_Nmm.z())},
    RecordColumn{"contacts", "", "sample points that touch", integer, true,
                 [](const TickRecord& r) -> double { return r.contacts; },
                 [](TickRecord& r, double value) { r.contacts = static_cast<int>(value); }},
    RecordColumn{"removed_mm3", "mm^3", "bone removed since the beginning, as bone of the reference density",
                 real, true, OSTEOMILL_FIELD(removed_mm3)},
    RecordColumn{"compute_us", "us", "time of the algorithm's step, by the clock", real, true,
                 OSTEOMILL_FIELD(compute_us)},
    RecordColumn{"milling_us", "us", "time of milling, by the clock", real, false,
                 OSTEOMILL_FIELD(milling_us)},
    RecordColumn{"tick_cpu_us", "us", "CPU time of the whole tick; 0 where it was not measured", real, false,
                 OSTEOMILL_FIELD(tick_cpu_us)},
    RecordColumn{"burr_force_x_N", "N", kBurrForce, real, false, OSTEOMILL_FIELD(burr_force_W_N.x())},
    RecordColumn{"burr_force_y_N", "N", kBurrForce, real, false, OSTEOMILL_FIELD(burr_force_W_N.y())},
    RecordColumn{"burr_force_z_N", "N", kBurrForce, real, false, OSTEOMILL_FIELD(burr_force_W_N.z())},
    RecordColumn{"dt_s", "s", "how long the tick was taken to be", real, false, OSTEOMILL_FIELD(dt_s)},
    RecordColumn{"spindle", "", "1 where the burr could cut", small_integer, false,
                 OSTEOMILL_FLAG(spindle_on)},
    RecordColumn{"fault", "", "what was done to the wrench (codes)", small_integer, false,
                 [](const TickRecord& r) -> double { return static_cast<double>(r.fault); },
                 [](TickRecord& r, double value) { r.fault = static_cast<WrenchFault>(value); }},
    RecordColumn{"energy_given_Nmm", "N mm",
                 "energy given to the hand less what it gave, since the session began", real, true,
                 OSTEOMILL_FIELD(energy_given_Nmm), true},
    RecordColumn{"paused", "", "1 in a pause: zero is sent and nothing computed", small_integer, false,
                 OSTEOMILL_FLAG(paused), true},
    RecordColumn{"let_go", "", "1 where from this tick on nothing is felt until the tool is placed",
                 small_integer, false, OSTEOMILL_FLAG(let_go), true},
    RecordColumn{"placed", "",
                 "1 where the tool was placed at the device before the tick, contacts forgotten",
                 small_integer, false, OSTEOMILL_FLAG(placed), true},
    RecordColumn{"given_share", "", "how much of the force that was asked for the device had sent by then",
                 real, false, OSTEOMILL_FIELD(given_share), true},
    RecordColumn{"cutting_torque_x_Nmm", "N mm", kCuttingTorque, real, false,
                 OSTEOMILL_FIELD(cutting_torque_W_Nmm.x()), true},
    RecordColumn{"cutting_torque_y_Nmm", "N mm", kCuttingTorque, real, false,
                 OSTEOMILL_FIELD(cutting_torque_W_Nmm.y()), true},
    RecordColumn{"cutting_torque_z_Nmm", "N mm", kCuttingTorque, real, false,
                 OSTEOMILL_FIELD(cutting_torque_W_Nmm.z()), true},
};

#undef OSTEOMILL_FLAG
#undef OSTEOMILL_FIELD

}  // namespace

std::span<const RecordColumn> record_columns() {
  return kColumns;
}

}  // namespace osteomill
