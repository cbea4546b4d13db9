#include "osteomill/recording/record_columns.h"

#include <iterator>
#include <ostream>
#include <string>

#include <fmt/format.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/recording/hdf5.h"
#include "osteomill/recording/view_sample.h"

namespace osteomill {

namespace {

template <typename Struct>
using Fields = std::vector<Field<Struct>>;

constexpr NumberRange kReal{-kMaxReal, kMaxReal, false};

template <typename Struct, typename Place>
void add_real(Fields<Struct>& fields, const char* name, const char* unit, Place place, const char* doc,
              unsigned flags = 0) {
  fields.push_back(field<Struct>({name, unit, kReal, doc, flags}, place));
}

template <typename Struct, typename Place>
void add_switch(Fields<Struct>& fields, const char* name, Place place, const char* doc, unsigned flags = 0) {
  fields.push_back(field<Struct>({name, "", NumberRange::on_or_off(), doc, flags}, place));
}

template <typename Struct, typename Place>
void add_vector(Fields<Struct>& fields, const std::string& name, const std::string& unit, Place place,
                const char* doc, unsigned flags = 0) {
  for (const int axis : {0, 1, 2}) {
    const std::string unit_in_name = unit == "N mm" ? "Nmm" : unit;
    const std::string column =
        fmt::format("{}_{}{}{}", name, "xyz"[axis], unit.empty() ? "" : "_", unit_in_name);
    fields.push_back(field<Struct>(
        {column, unit, kReal, doc, flags},
        [ place, axis ](auto& record) -> auto& { return place(record)[axis]; }));
  }
}

template <typename Struct, typename Place>
void add_pose(Fields<Struct>& fields, const std::string& name, Place place, const char* position_doc,
              const char* turn_doc, unsigned flags) {
  add_vector(
      fields, name, "mm", [place](auto& r) -> auto& { return (r.*place).position_mm; }, position_doc, flags);
  // w first; the indices follow Eigen's storage order x, y, z, w.
  constexpr int kW = 3;
  for (const int part : {kW, 0, 1, 2}) {
    fields.push_back(field<Struct>(
        {fmt::format("{}_q{}", name, "xyzw"[part]), "", kReal, turn_doc, flags},
        [ place, part ](auto& r) -> auto& { return (r.*place).orientation.coeffs()[part]; }));
  }
}

FieldDescription fault_column() {
  constexpr int kLast = static_cast<int>(WrenchFault::held_back);
  FieldDescription column{.name = "fault",
                          .range = NumberRange::count(0, kLast),
                          .doc = "how the wrench was altered before it was sent (codes)"};
  for (int code = 0; code <= kLast; ++code)
    column.choices.emplace_back(name_of(static_cast<WrenchFault>(code)));
  return column;
}

Fields<TickRecord> record_fields() {
  using R = TickRecord;
  Fields<R> all;
  add_real(all, "time_s", "s", &R::time_s, "start time of the tick", kInLog);
  add_pose(all, "device", &R::X_WD,
           "device pose as read (X_WD), the burr's centre, frame W; not finite without a pose",
           "device's orientation in W, unit quaternion", kInLog | kMayBeNotFinite);
  add_pose(all, "tool", &R::X_WT, "simulated tool (X_WT), the burr's centre, frame W",
           "simulated tool's orientation in W, unit quaternion; the shaft points along its +z", kInLog);
  add_vector(
      all, "force", "N", [](auto& r) -> auto& { return r.wrench.force_N; }, "force sent to the hand, frame W",
      kInLog);
  add_vector(
      all, "torque", "N mm", [](auto& r) -> auto& { return r.wrench.torque_Nmm; },
      "torque sent to the hand, frame W, about the burr's centre", kInLog);
  all.push_back(
      field<R>({"contacts", "", NumberRange::count(0), "sample points in contact", kInLog}, &R::contacts));
  add_real(all, "removed_mm3", "mm^3", &R::removed_mm3,
           "bone removed since the start, counted as bone of the reference density", kInLog);
  add_real(all, "compute_us", "us", &R::compute_us, "time of the algorithm's step, by the clock",
           kInLog | kMeasuredTime);
  add_real(all, "milling_us", "us", &R::milling_us, "time of milling, by the clock", kMeasuredTime);
  add_real(all, "tick_cpu_us", "us", &R::tick_cpu_us, "CPU time of the whole tick; 0 if it was not measured",
           kMeasuredTime);
  add_vector(
      all, "burr_force", "N", [](auto& r) -> auto& { return r.burr_force_W_N; },
      "force of the burr on the bone, frame W");
  add_real(all, "dt_s", "s", &R::dt_s, "time step with which the tick was computed");
  add_switch(all, "spindle", &R::spindle_on, "1 if the burr could cut");
  all.push_back(field<R>(fault_column(), &R::fault));
  add_real(all, "energy_given_Nmm", "N mm", &R::energy_given_Nmm,
           "net energy given to the hand since the session began", kInLog);
  add_switch(all, "paused", &R::paused, "1 in a pause: zero is sent and nothing computed");
  add_switch(all, "let_go", &R::fade_out,
             "1 if the force fades out from this tick on, until the tool is placed");
  add_switch(all, "placed", &R::placed,
             "1 if the tool was placed at the device before the tick, contacts forgotten");
  all.push_back(field<R>(
      {"owed_bricks", "", NumberRange::count(0),
       "bricks of bone points that may still contain removed bone, because their update was deferred"},
      &R::pending_bricks));
  add_real(all, "given_share", "", &R::delivered_fraction,
           "fraction of the requested force that the device had delivered by then");
  add_vector(
      all, "cutting_torque", "N mm", [](auto& r) -> auto& { return r.cutting_torque_W_Nmm; },
      "part of the sent torque that is due to cutting (--cutting-reaction), frame W");
  add_switch(all, "driven", &R::driven, "1 if the sent wrench reached a hand", kMayBeAbsent);
  add_real(all, "spindle_rpm", "rpm", &R::spindle_rpm, "true speed of the spindle", kInLog | kMayBeAbsent);
  add_real(all, "cutting_power_W", "W", &R::cutting_power_W, "power spent on removing bone",
           kInLog | kMayBeAbsent);
  add_real(all, "cut_density", "", &R::cut_density,
           "density before the burr relative to the reference; 0 without contact", kMayBeAbsent);
  add_real(all, "no_go_distance_mm", "mm", &R::no_go_distance_mm,
           "distance from the burr's surface to the nearest no-go structure of the exercise; "
           "NaN without one",
           kMayBeAbsent | kMayBeNotFinite);
  return all;
}

Fields<ViewSample> view_fields() {
  using V = ViewSample;
  Fields<V> all;
  add_real(all, "time_s", "s", &V::time_s, "time of the tick shown");
  add_pose(all, "camera", &V::X_WC, "eye (X_WC), frame W",
           "its orientation in W, unit quaternion: x to the right, y up, z towards the viewer", 0);
  add_real(all, "field_of_view_rad", "rad", &V::field_of_view_rad, "vertical field of view");
  add_real(all, "aspect", "", &V::aspect, "aspect ratio, width / height");
  for (const std::size_t n : {0u, 1u, 2u, 3u}) {
    const std::string cut = fmt::format("cut_{}", n + 1);
    add_vector(
        all, cut, "", [n](auto& v) -> auto& { return v.cuts[n].normal_W; },
        "normal of a cut: points p with normal . p < offset are not shown; zero if there is none");
    add_real(
        all, (cut + "_offset_mm").c_str(), "mm", [n](auto& v) -> auto& { return v.cuts[n].offset_mm; },
        "offset of the cut");
  }
  all.push_back(
      field<V>({"step", "", NumberRange::count(0), "step of the exercise, from 1; 0 for none"}, &V::step));
  add_switch(all, "guidance", &V::has_guidance, "1 if steps, colours and distances were shown");
  return all;
}

// Appends a line of the log: the text that `write` returns for each column.
template <typename Write>
void append_line(fmt::memory_buffer& text, const Write& write) {
  const char* separator = "";
  for (const Field<TickRecord>& column : fields_of<TickRecord>()) {
    if (!column.has(kInLog)) continue;
    fmt::format_to(std::back_inserter(text), "{}{}", separator, write(column));
    separator = ",";
  }
  text.push_back('\n');
}

}  // namespace

template <>
const Fields<TickRecord>& fields_of<TickRecord>() {
  static const Fields<TickRecord> all = record_fields();
  return all;
}

template <>
const Fields<ViewSample>& fields_of<ViewSample>() {
  static const Fields<ViewSample> all = view_fields();
  return all;
}

void write_csv(const std::filesystem::path& path, std::span<const TickRecord> records) {
  write_text_atomically(path, [&](std::ostream& out) {
    fmt::memory_buffer text;
    append_line(text, [](const auto& column) { return column.name; });
    for (const TickRecord& record : records) {
      append_line(text, [&](const auto& column) { return column.get(record); });
      out.write(text.data(), static_cast<std::streamsize>(text.size()));
      text.clear();
    }
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
  });
}

}  // namespace osteomill
