#include "osteomill/recording/record_columns.h"

#include <array>

namespace osteomill {

namespace {

using enum ColumnType;

#define OSTEOMILL_FIELD(field) \
  [](const TickRecord& r) -> double { return r.field; }, [](TickRecord& r, double value) { r.field = value; }

constexpr std::array kColumns{
    RecordColumn{"time_s", "s", real, true, OSTEOMILL_FIELD(time_s)},
    RecordColumn{"device_x_mm", "mm", real, true, OSTEOMILL_FIELD(X_WD.position_mm.x())},
    RecordColumn{"device_y_mm", "mm", real, true, OSTEOMILL_FIELD(X_WD.position_mm.y())},
    RecordColumn{"device_z_mm", "mm", real, true, OSTEOMILL_FIELD(X_WD.position_mm.z())},
    RecordColumn{"device_qw", "", real, true, OSTEOMILL_FIELD(X_WD.orientation.w())},
    RecordColumn{"device_qx", "", real, true, OSTEOMILL_FIELD(X_WD.orientation.x())},
    RecordColumn{"device_qy", "", real, true, OSTEOMILL_FIELD(X_WD.orientation.y())},
    RecordColumn{"device_qz", "", real, true, OSTEOMILL_FIELD(X_WD.orientation.z())},
    RecordColumn{"tool_x_mm", "mm", real, true, OSTEOMILL_FIELD(X_WT.position_mm.x())},
    RecordColumn{"tool_y_mm", "mm", real, true, OSTEOMILL_FIELD(X_WT.position_mm.y())},
    RecordColumn{"tool_z_mm", "mm", real, true, OSTEOMILL_FIELD(X_WT.position_mm.z())},
    RecordColumn{"tool_qw", "", real, true, OSTEOMILL_FIELD(X_WT.orientation.w())},
    RecordColumn{"tool_qx", "", real, true, OSTEOMILL_FIELD(X_WT.orientation.x())},
    RecordColumn{"tool_qy", "", real, true, OSTEOMILL_FIELD(X_WT.orientation.y())},
    RecordColumn{"tool_qz", "", real, true, OSTEOMILL_FIELD(X_WT.orientation.z())},
    RecordColumn{"force_x_N", "N", real, true, OSTEOMILL_FIELD(wrench.force_N.x())},
    RecordColumn{"force_y_N", "N", real, true, OSTEOMILL_FIELD(wrench.force_N.y())},
    RecordColumn{"force_z_N", "N", real, true, OSTEOMILL_FIELD(wrench.force_N.z())},
    RecordColumn{"torque_x_Nmm", "N mm", real, true, OSTEOMILL_FIELD(wrench.torque_Nmm.x())},
    RecordColumn{"torque_y_Nmm", "N mm", real, true, OSTEOMILL_FIELD(wrench.torque_Nmm.y())},
    RecordColumn{"torque_z_Nmm", "N mm", real, true, OSTEOMILL_FIELD(wrench.torque_Nmm.z())},
    RecordColumn{"contacts", "", integer, true, [](const TickRecord& r) -> double { return r.contacts; },
                 [](TickRecord& r, double value) { r.contacts = static_cast<int>(value); }},
    RecordColumn{"removed_mm3", "mm^3", real, true, OSTEOMILL_FIELD(removed_mm3)},
    RecordColumn{"compute_us", "us", real, true, OSTEOMILL_FIELD(compute_us)},
    RecordColumn{"milling_us", "us", real, false, OSTEOMILL_FIELD(milling_us)},
    RecordColumn{"tick_cpu_us", "us", real, false, OSTEOMILL_FIELD(tick_cpu_us)},
    RecordColumn{"burr_force_x_N", "N", real, false, OSTEOMILL_FIELD(burr_force_W_N.x())},
    RecordColumn{"burr_force_y_N", "N", real, false, OSTEOMILL_FIELD(burr_force_W_N.y())},
    RecordColumn{"burr_force_z_N", "N", real, false, OSTEOMILL_FIELD(burr_force_W_N.z())},
    RecordColumn{"dt_s", "s", real, false, OSTEOMILL_FIELD(dt_s)},
    RecordColumn{"spindle", "", small_integer, false,
                 [](const TickRecord& r) -> double { return r.spindle_on ? 1 : 0; },
                 [](TickRecord& r, double value) { r.spindle_on = value != 0; }},
    RecordColumn{"fault", "", small_integer, false,
                 [](const TickRecord& r) -> double { return static_cast<double>(r.fault); },
                 [](TickRecord& r, double value) { r.fault = static_cast<WrenchFault>(value); }},
    RecordColumn{"energy_given_Nmm", "N mm", real, true, OSTEOMILL_FIELD(energy_given_Nmm), true},
};

#undef OSTEOMILL_FIELD

}  // namespace

std::span<const RecordColumn> record_columns() {
  return kColumns;
}

}  // namespace osteomill
