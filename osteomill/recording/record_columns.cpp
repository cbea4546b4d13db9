#include "osteomill/recording/record_columns.h"

#include <array>
#include <iterator>
#include <ostream>

#include <fmt/format.h>

#include "osteomill/files/atomic_file.h"

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

constexpr RecordColumn real_column(const char* name, const char* unit, const char* meaning, bool in_log,
                                   double (*get)(const TickRecord&), void (*set)(TickRecord&, double)) {
  return {name, unit, meaning, real, in_log, get, set};
}

#define OSTEOMILL_VECTOR(name, unit_in_name, unit, meaning, in_log, field)                     \
  real_column(name "_x_" unit_in_name, unit, meaning, in_log, OSTEOMILL_FIELD(field.x())),     \
      real_column(name "_y_" unit_in_name, unit, meaning, in_log, OSTEOMILL_FIELD(field.y())), \
      real_column(name "_z_" unit_in_name, unit, meaning, in_log, OSTEOMILL_FIELD(field.z()))

#define OSTEOMILL_TURN(name, meaning, field)                                  \
  real_column(name "_qw", "", meaning, true, OSTEOMILL_FIELD(field.w())),     \
      real_column(name "_qx", "", meaning, true, OSTEOMILL_FIELD(field.x())), \
      real_column(name "_qy", "", meaning, true, OSTEOMILL_FIELD(field.y())), \
      real_column(name "_qz", "", meaning, true, OSTEOMILL_FIELD(field.z()))

constexpr std::array kColumns{
    RecordColumn{"time_s", "s", "when the tick began", real, true, OSTEOMILL_FIELD(time_s)},
    OSTEOMILL_VECTOR("device", "mm", "mm", kDevicePosition, true, X_WD.position_mm),
    OSTEOMILL_TURN("device", kDeviceTurn, X_WD.orientation),
    OSTEOMILL_VECTOR("tool", "mm", "mm", kToolPosition, true, X_WT.position_mm),
    OSTEOMILL_TURN("tool", kToolTurn, X_WT.orientation),
    OSTEOMILL_VECTOR("force", "N", "N", kForce, true, wrench.force_N),
    OSTEOMILL_VECTOR("torque", "Nmm", "N mm", kTorque, true, wrench.torque_Nmm),
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
    OSTEOMILL_VECTOR("burr_force", "N", "N", kBurrForce, false, burr_force_W_N),
    RecordColumn{"dt_s", "s", "how long the tick was taken to be", real, false, OSTEOMILL_FIELD(dt_s)},
    RecordColumn{"spindle", "", "1 where the burr could cut", small_integer, false,
                 OSTEOMILL_FLAG(spindle_on)},
    RecordColumn{"fault", "", "what was done to the wrench (codes)", small_integer, false,
                 [](const TickRecord& r) -> double { return static_cast<double>(r.fault); },
                 [](TickRecord& r, double value) { r.fault = static_cast<WrenchFault>(value); }},
    RecordColumn{"energy_given_Nmm", "N mm",
                 "energy given to the hand less what it gave, since the session began", real, true,
                 OSTEOMILL_FIELD(energy_given_Nmm)},
    RecordColumn{"paused", "", "1 in a pause: zero is sent and nothing computed", small_integer, false,
                 OSTEOMILL_FLAG(paused)},
    RecordColumn{"let_go", "", "1 where from this tick on nothing is felt until the tool is placed",
                 small_integer, false, OSTEOMILL_FLAG(let_go)},
    RecordColumn{"placed", "",
                 "1 where the tool was placed at the device before the tick, contacts forgotten",
                 small_integer, false, OSTEOMILL_FLAG(placed)},
    RecordColumn{"owed_bricks", "",
                 "bricks of bone points that may have shown more bone than there was, left to later ticks",
                 integer, false, [](const TickRecord& r) -> double { return r.owed_bricks; },
                 [](TickRecord& r, double value) { r.owed_bricks = static_cast<int>(value); }},
    RecordColumn{"given_share", "", "how much of the force that was asked for the device had sent by then",
                 real, false, OSTEOMILL_FIELD(given_share)},
    OSTEOMILL_VECTOR("cutting_torque", "Nmm", "N mm", kCuttingTorque, false, cutting_torque_W_Nmm),
};

#undef OSTEOMILL_TURN
#undef OSTEOMILL_VECTOR
#undef OSTEOMILL_FLAG
#undef OSTEOMILL_FIELD

// A line of the log: of each column what `write` appends.
template <typename Write>
void append_line(fmt::memory_buffer& text, const Write& write) {
  const char* separator = "";
  for (const RecordColumn& column : record_columns()) {
    if (!column.in_log) continue;
    fmt::format_to(std::back_inserter(text), "{}{}", separator, write(column));
    separator = ",";
  }
  text.push_back('\n');
}

}  // namespace

std::span<const RecordColumn> record_columns() {
  return kColumns;
}

void write_csv(const std::filesystem::path& path, std::span<const TickRecord> records) {
  write_text_atomically(path, [&](std::ostream& out) {
    fmt::memory_buffer text;
    append_line(text, [](const RecordColumn& column) { return column.name; });
    for (const TickRecord& record : records) {
      append_line(text, [&](const RecordColumn& column) { return column.get(record); });
      out.write(text.data(), static_cast<std::streamsize>(text.size()));
      text.clear();
    }
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
  });
}

}  // namespace osteomill
