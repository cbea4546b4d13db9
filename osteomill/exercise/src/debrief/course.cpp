#include "debrief/course.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "osteomill/base/run_program.h"
#include "osteomill/exercise/moments.h"

#include "debrief/bodies.h"

namespace osteomill {

namespace {

using nlohmann::json;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

// Named columns of samples.
class Columns {
 public:
  void add(const char* name, std::initializer_list<double> numbers) {
    std::vector<float>& column = columns_[name];
    for (const double number : numbers) column.push_back(static_cast<float>(number));
  }
  json packed_columns() const {
    json all;
    for (const auto& [name, column] : columns_) all[name] = packed(column);
    return all;
  }

 private:
  std::map<std::string, std::vector<float>> columns_;
};

// Returns the last tick of each sample, starting at a tick: 30 samples a second, fewer in long sessions.
std::vector<std::size_t> sampled_ticks(const std::vector<AttemptTick>& ticks, std::size_t from = 0) {
  constexpr double kMost = 6000, kEvery_s = 1.0 / 30;
  std::vector<std::size_t> sampled;
  if (from >= ticks.size()) return sampled;
  const double every_s = std::max(kEvery_s, (ticks.back().time_s - ticks[from].time_s) / kMost);
  for (std::size_t n = from; n < ticks.size(); ++n) {
    if (sampled.empty() || n + 1 == ticks.size() || ticks[n].time_s - ticks[sampled.back()].time_s >= every_s)
      sampled.push_back(n);
  }
  return sampled;
}

// Returns the maximum force, minimum distance and removed bone over each sample's ticks.
Columns felt_samples(const Attempt& attempt, const std::vector<std::size_t>& sampled) {
  Columns samples;
  std::size_t n = sampled.empty() ? 0 : sampled.front();
  for (const std::size_t last : sampled) {
    double force_N = 0, distance_mm = kNoNumber, removed_mm3 = 0;
    for (; n <= last; ++n) {
      force_N = std::max(force_N, attempt.ticks[n].force_N);
      distance_mm = std::fmin(distance_mm, attempt.distance_mm(n));
      removed_mm3 += attempt.ticks[n].removed_mm3;
    }
    samples.add("time", {attempt.ticks[last].time_s});
    samples.add("force", {force_N});
    samples.add("distance", {distance_mm});
    samples.add("removed", {removed_mm3});
  }
  return samples;
}

// Returns the same, with the tool at the end of each sample.
json samples_of(const Attempt& attempt, const Recording& recording, const std::vector<std::size_t>& sampled) {
  Columns samples = felt_samples(attempt, sampled);
  for (const std::size_t n : sampled) {
    const AttemptTick& tick = attempt.ticks[n];
    const Vec3 place_W = tick.is_placed ? tick.burr_W : Vec3::Constant(kNoNumber);
    const Vec3 shaft_W = recording.records[n].X_WT.orientation * Vec3::UnitZ();
    samples.add("place", {place_W.x(), place_W.y(), place_W.z()});
    samples.add("shaft", {shaft_W.x(), shaft_W.y(), shaft_W.z()});
    samples.add("radius", {tick.burr_radius_mm});
  }
  return samples.packed_columns();
}

// Returns the trainee's view at each sample; NaN before the first view.
json views_of(const Attempt& attempt, const std::vector<std::size_t>& sampled) {
  Columns columns;
  auto next = attempt.views.begin();
  for (const std::size_t tick : sampled) {
    while (next != attempt.views.end() && next->time_s <= attempt.ticks[tick].time_s) ++next;
    ViewSample view;
    view.X_WC.position_mm = Vec3::Constant(kNoNumber);
    if (next != attempt.views.begin()) view = *std::prev(next);
    const Vec3& eye_W = view.X_WC.position_mm;
    const Quat& turn = view.X_WC.orientation;
    columns.add("eye", {eye_W.x(), eye_W.y(), eye_W.z()});
    columns.add("turn", {turn.x(), turn.y(), turn.z(), turn.w()});
    constexpr double kDegrees = 57.29577951308232;
    columns.add("fov", {kDegrees * view.field_of_view_rad});
  }
  return columns.packed_columns();
}

// Returns the burrs in order: the first tick with each, and its name.
std::vector<std::pair<std::size_t, std::string>> burrs_of(const Recording& recording) {
  std::vector<std::pair<std::size_t, std::string>> burrs;
  for (const RecordedSession& session : recording.sessions) {
    const SessionSettings settings = session_settings(session.start.run, recording.path);
    const std::string name =
        fmt::format("{} burr of {:g} mm", settings.setup.burr == BurrEdge::diamond ? "diamond" : "round",
                    2 * session.start.run.tool.burr_radius_mm);
    if (burrs.empty() || burrs.back().second != name) burrs.emplace_back(session.first, name);
  }
  return burrs;
}

std::string command_at(const std::string& recording_name, double time_s) {
  return fmt::format("osteomill simulate --from {} --at {:.6f}", quoted(recording_name), time_s);
}

// Returns the moments that fit into a page: contacts first, then the largest removals.
std::vector<Moment> select_shown(std::vector<Moment> moments) {
  constexpr std::size_t kMost = 500;
  if (moments.size() <= kMost) return moments;
  std::ranges::stable_sort(moments, std::ranges::greater(), [](const Moment& one) {
    return one.kind == Moment::Kind::contact ? std::numeric_limits<double>::infinity() : one.removed_mm3;
  });
  moments.resize(kMost);
  std::ranges::stable_sort(moments, {}, &Moment::first_tick);
  return moments;
}

// Describes what is missing from the marks; empty if nothing is.
std::string unlisted_text(const std::vector<Moment>& all, const std::vector<Moment>& shown) {
  const auto left_out = [&](Moment::Kind kind) {
    return std::ranges::count(all, kind, &Moment::kind) - std::ranges::count(shown, kind, &Moment::kind);
  };
  if (shown.size() == all.size()) return "";
  return fmt::format("Not marked: {} later contacts, and {} smaller removals outside the target.",
                     left_out(Moment::Kind::contact), left_out(Moment::Kind::outside));
}

template <typename... Others>
std::string if_known(fmt::format_string<double&, const Others&...> text, double number,
                     const Others&... others) {
  return std::isnan(number) ? "not known" : fmt::format(text, number, others...);
}

json mark_of(const Moment& moment, const Attempt& attempt, const std::string& burr,
             const std::string& recording_name) {
  const AttemptTick& tick = attempt.ticks[moment.first_tick];
  const bool is_contact = moment.kind == Moment::Kind::contact;
  const std::vector<PlacedStructure>& structures = attempt.exercise->structures;
  std::size_t nearest = moment.structure;
  if (!is_contact)
    for (std::size_t n = 0; n < structures.size(); ++n)
      if (attempt.distance_mm(moment.first_tick, n) < attempt.distance_mm(moment.first_tick, nearest))
        nearest = n;
  json facts = json::array();
  facts.push_back({"when", fmt::format("{:.3f} s", tick.time_s)});
  facts.push_back({"burr", burr});
  facts.push_back({"force", fmt::format("{:.2f} N, at most {:.2f} N", tick.force_N, moment.force_max_N)});
  if (!structures.empty())
    facts.push_back(
        {"distance", if_known("{:.2f} mm from {}", attempt.distance_mm(moment.first_tick, nearest),
                              structures[nearest].name)});
  facts.push_back({"speed", if_known("{:.1f} mm/s", burr_speed_mm_s(attempt, moment.first_tick))});
  facts.push_back({"lasted", fmt::format("{:.3f} s", moment.time_s)});
  if (!is_contact) facts.push_back({"removed outside", fmt::format("{:.3g} mm³", moment.removed_mm3)});
  const std::string what = is_contact
                               ? "contact with " + structures[moment.structure].name
                               : fmt::format("{:.2g} mm³ removed outside the target", moment.removed_mm3);
  return {{"kind", is_contact ? "contact" : "outside"},
          {"time", tick.time_s},
          {"place", numbers_of(tick.burr_W)},
          {"title", fmt::format("{:.2f} s: {}", tick.time_s, what)},
          {"facts", std::move(facts)},
          {"command", command_at(recording_name, tick.time_s)}};
}

}  // namespace

json curve_of(const std::vector<AttemptProgress>& progress) {
  json time = json::array(), target = json::array(), outside = json::array();
  for (const AttemptProgress& at : progress) {
    time.push_back(at.time_s);
    target.push_back(at.target_removed_percent);
    outside.push_back(at.removed_outside_mm3);
  }
  return {{"time", std::move(time)}, {"target", std::move(target)}, {"outside", std::move(outside)}};
}

void put_course(json& data, const Attempt& attempt, const Recording& recording,
                const std::string& recording_name) {
  const PlacedExercise& exercise = *attempt.exercise;
  const std::vector<std::size_t> sampled = sampled_ticks(attempt.ticks);
  data["samples"] = samples_of(attempt, recording, sampled);
  if (!attempt.views.empty()) data["views"] = views_of(attempt, sampled);
  data["progress"] = curve_of(progress_of(attempt));
  data["structures"] = exercise.structures.size();
  data["warn_mm"] = 0;
  for (const PlacedStructure& structure : exercise.structures)
    data["warn_mm"] = std::max(data["warn_mm"].get<double>(), structure.warn_mm);
  data["steps"] = data["burrs"] = data["marks"] = json::array();
  for (std::size_t n = 0; n < exercise.steps.size(); ++n) {
    const double done_s = step_completion_s(attempt, n);
    data["steps"].push_back({{"done_s", std::isnan(done_s) ? json() : json(done_s)}});
  }
  const auto burrs = burrs_of(recording);
  for (const auto& [tick, name] : burrs)
    if (tick < attempt.ticks.size())
      data["burrs"].push_back({{"time", attempt.ticks[tick].time_s}, {"text", name}});
  const std::vector<Moment> moments = moments_of(attempt), shown = select_shown(moments);
  data["unlisted"] = unlisted_text(moments, shown);
  for (const Moment& moment : shown) {
    const auto later =
        std::ranges::upper_bound(burrs, moment.first_tick, {}, &std::pair<std::size_t, std::string>::first);
    data["marks"].push_back(mark_of(moment, attempt, std::prev(later)->second, recording_name));
  }
}

void put_original_attempt(json& data, const OriginalAttempt& first, const std::string& recording_name) {
  const std::size_t parting = first.from.ticks - 1;
  const AttemptTick& tick = first.attempt.ticks[parting];
  std::vector<AttemptProgress> rest = first.measured.progress;
  std::erase_if(rest, [&](const AttemptProgress& at) { return at.time_s < tick.time_s; });
  data["first"] = {
      {"samples", felt_samples(first.attempt, sampled_ticks(first.attempt.ticks, parting)).packed_columns()},
      {"progress", curve_of(rest)}};
  json mark = {{"kind", "parting"},
               {"time", tick.time_s},
               {"place", numbers_of(tick.burr_W)},
               {"title", fmt::format("{:.2f} s: branch point", tick.time_s)},
               {"facts", json::array({json::array({"when", fmt::format("{:.3f} s", tick.time_s)}),
                                      json::array({"ticks in common", std::to_string(first.from.ticks)})})},
               {"command", command_at(recording_name, tick.time_s)}};
  auto& marks = data["marks"].get_ref<json::array_t&>();
  const auto is_later = [&](const json& one) { return one["time"].get<double>() > tick.time_s; };
  marks.insert(std::ranges::find_if(marks, is_later), std::move(mark));
}

}  // namespace osteomill
