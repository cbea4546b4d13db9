#include "osteomill/exercise/measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <ostream>
#include <utility>

#include <fmt/format.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/csv_field.h"
#include "osteomill/base/distribution.h"
#include "osteomill/base/work_progress.h"
#include "osteomill/exercise/moments.h"
#include "osteomill/exercise/region_voxels.h"

#include "crown.h"

namespace osteomill {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double ratio(double part, double whole) {
  return whole > 0 ? part / whole : kNone;
}

double share(std::vector<double> values, double part) {
  return values.empty() ? kNone : percentile(std::move(values), part);
}

// Removed bone.

std::size_t removed_of(const Attempt& attempt, const VoxelSet& voxels) {
  std::size_t count = 0;
  voxels.for_each([&](const VoxelIndex& v) {
    if (attempt.removed.contains(v)) ++count;
  });
  return count;
}

double target_removed_percent(const Attempt& attempt) {
  const VoxelSet& target = attempt.exercise->target;
  return 100 * ratio(static_cast<double>(removed_of(attempt, target)), static_cast<double>(target.count()));
}

double removed_outside_mm3(const Attempt& attempt) {
  std::size_t outside = 0;
  attempt.removed.for_each([&](const VoxelIndex& v) {
    if (attempt.exercise->is_outside(v)) ++outside;
  });
  return attempt.exercise->volume_mm3(outside);
}

double removed_outside_percent(const Attempt& attempt) {
  const PlacedExercise& exercise = *attempt.exercise;
  return 100 * ratio(removed_outside_mm3(attempt), exercise.volume_mm3(exercise.target.count()));
}

double removed_mm3(const Attempt& attempt) {
  return attempt.exercise->volume_mm3(attempt.removed.count());
}

double dice_percent(const Attempt& attempt) {
  const VoxelSet& target = attempt.exercise->target;
  return 200 * ratio(static_cast<double>(removed_of(attempt, target)),
                     static_cast<double>(target.count() + attempt.removed.count()));
}

double keep_removed_mm3(const Attempt& attempt) {
  const PlacedExercise& exercise = *attempt.exercise;
  return exercise.keep.empty() ? kNone : exercise.volume_mm3(removed_of(attempt, exercise.keep));
}

// No-go structures. Measured separately, and over all of them.

using OfStructure = std::function<double(const Attempt&, std::size_t)>;

// Returns the minimum or maximum over those structures that have a value.
std::function<double(const Attempt&)> worst_of(OfStructure one, bool is_least) {
  return [one = std::move(one), is_least](const Attempt& attempt) {
    double worst = kNone;
    for (std::size_t n = 0; n < attempt.exercise->structures.size(); ++n)
      worst = is_least ? std::fmin(worst, one(attempt, n)) : std::fmax(worst, one(attempt, n));
    return worst;
  };
}

// Contacts with one structure, or with the nearest one.
struct Contacts {
  double count = 0;
  double time_s = 0;
  double first_s = kNone;
  double force_max_N = kNone;
  double min_distance_mm = kNone;
};

Contacts contacts_with(const Attempt& attempt, std::optional<std::size_t> structure) {
  Contacts found;
  for (std::size_t n = 0; n < attempt.ticks.size(); ++n) {
    found.min_distance_mm = std::fmin(
        found.min_distance_mm, structure ? attempt.distance_mm(n, *structure) : attempt.distance_mm(n));
  }
  for (const Moment& contact : contacts_of(attempt, structure)) {
    ++found.count;
    found.time_s += contact.time_s;
    found.first_s = std::fmin(found.first_s, attempt.ticks[contact.first_tick].time_s);
    found.force_max_N = std::fmax(found.force_max_N, contact.force_max_N);
  }
  return found;
}

double no_go_removed_mm3(const Attempt& attempt, std::size_t structure) {
  const PlacedExercise& exercise = *attempt.exercise;
  return exercise.volume_mm3(removed_of(attempt, exercise.structures[structure].voxels));
}

double no_go_removed_of_all_mm3(const Attempt& attempt) {
  const PlacedExercise& exercise = *attempt.exercise;
  std::size_t count = 0;
  attempt.removed.for_each([&](const VoxelIndex& v) {
    const bool is_in = std::ranges::any_of(
        exercise.structures, [&](const PlacedStructure& one) { return one.voxels.contains(v); });
    if (is_in) ++count;
  });
  return exercise.structures.empty() ? kNone : exercise.volume_mm3(count);
}

// Creates a measure from a member of Contacts: for the nearest structure in each tick, and for each
// structure.
Measure of_contact(std::string name, std::string unit, std::string formula, std::string source,
                   double Contacts::*part) {
  Measure measure{std::move(name), std::move(unit), std::move(formula), std::move(source), {}};
  measure.value = [part](const Attempt& attempt) {
    if (attempt.exercise->structures.empty()) return kNone;
    return contacts_with(attempt, std::nullopt).*part;
  };
  measure.each = Measure::Each::structure;
  measure.value_at = [part](const Attempt& attempt, std::size_t structure) {
    return contacts_with(attempt, structure).*part;
  };
  return measure;
}

// Creates a measure for each structure, and for all the minimum or maximum of those that have a value.
Measure of_structure(std::string name, std::string unit, std::string formula, std::string source,
                     OfStructure one, bool is_least) {
  Measure measure{std::move(name), std::move(unit), std::move(formula), std::move(source),
                  worst_of(one, is_least)};
  measure.each = Measure::Each::structure;
  measure.value_at = std::move(one);
  return measure;
}

double thickness_left_mm(const Attempt& attempt, std::size_t structure, double part) {
  std::vector<double> left_mm;
  for (const ThicknessLeft& place : attempt.thickness_left[structure]) left_mm.push_back(place.left_mm);
  return share(std::move(left_mm), part);
}

double thickness_left_min_mm(const Attempt& attempt, std::size_t structure) {
  return thickness_left_mm(attempt, structure, 0);
}

double thickness_left_median_mm(const Attempt& attempt, std::size_t structure) {
  return thickness_left_mm(attempt, structure, 0.5);
}

// Time, strokes and force.

double duration_s(const Attempt& attempt) {
  double sum_s = 0;
  for (const AttemptTick& tick : attempt.ticks) sum_s += tick.dt_s;
  return sum_s;
}

double cutting_s(const Attempt& attempt) {
  double sum_s = 0;
  for (const AttemptTick& tick : attempt.ticks) sum_s += tick.is_cutting() ? tick.dt_s : 0;
  return sum_s;
}

double idle_s(const Attempt& attempt) {
  return duration_s(attempt) - cutting_s(attempt);
}

double strokes(const Attempt& attempt) {
  return static_cast<double>(strokes_of(attempt.ticks).size());
}

double of_strokes(const Attempt& attempt, double Stroke::*quantity) {
  std::vector<double> values;
  for (const Stroke& stroke : strokes_of(attempt.ticks)) values.push_back(stroke.*quantity);
  return share(std::move(values), 0.5);
}

/// Range of distances from the nearest structure, mm.
struct Zone {
  double from_mm = -std::numeric_limits<double>::infinity();
  double to_mm = std::numeric_limits<double>::infinity();
  const char* name = "";
};
constexpr double kNear_mm = 4, kFar_mm = 8;
constexpr Zone kNear{.to_mm = kNear_mm, .name = "near"};
constexpr Zone kMiddle{.from_mm = kNear_mm, .to_mm = kFar_mm, .name = "middle"};
constexpr Zone kFar{.from_mm = kFar_mm, .name = "far"};

// Returns the ticks that cut in a zone; without a zone, all that cut.
std::vector<AttemptTick> cutting_ticks(const Attempt& attempt, const Zone* zone) {
  std::vector<AttemptTick> ticks;
  for (std::size_t n = 0; n < attempt.ticks.size(); ++n) {
    if (!attempt.ticks[n].is_cutting()) continue;
    const double distance_mm = zone == nullptr ? 0 : attempt.distance_mm(n);
    if (zone == nullptr || (distance_mm >= zone->from_mm && distance_mm < zone->to_mm))
      ticks.push_back(attempt.ticks[n]);
  }
  return ticks;
}

double cutting_share(const Attempt& attempt, const Zone* zone, double AttemptTick::*quantity, double part) {
  std::vector<double> values;
  for (const AttemptTick& tick : cutting_ticks(attempt, zone)) values.push_back(tick.*quantity);
  return share(std::move(values), part);
}

double removal_rate_mm3_s(const Attempt& attempt, const Zone* zone) {
  double removed = 0, time_s = 0;
  for (const AttemptTick& tick : cutting_ticks(attempt, zone)) {
    removed += tick.removed_mm3;
    time_s += tick.dt_s;
  }
  return ratio(removed, time_s);
}

// Time for each step, and progress over time.

// Returns the time from completion of all earlier steps, or from the beginning, until this one was completed.
double step_s(const Attempt& attempt, std::size_t step) {
  if (attempt.ticks.empty()) return kNone;
  double from_s = attempt.ticks.front().time_s;
  for (std::size_t n = 0; n < step; ++n) from_s = std::fmax(from_s, step_completion_s(attempt, n));
  return std::fmax(step_completion_s(attempt, step) - from_s,
                   std::isnan(step_completion_s(attempt, step)) ? kNone : 0);
}

double steps_s(const Attempt& attempt) {
  double sum_s = attempt.exercise->steps.empty() ? kNone : 0;
  for (std::size_t n = 0; n < attempt.exercise->steps.size(); ++n) sum_s += step_s(attempt, n);
  return sum_s;
}

// Returns the progress at the largest Dice coefficient, which falls again if bone is removed outside the
// target.
AttemptProgress peak_of(const Attempt& attempt) {
  const std::vector<AttemptProgress> way = progress_of(attempt);
  const auto peak = std::ranges::max_element(way, {}, &AttemptProgress::dice_percent);
  return peak == way.end() ? AttemptProgress{kNone, kNone, kNone, kNone} : *peak;
}

// The trainee's view.

double hidden_cutting_percent(const Attempt& attempt) {
  double hidden_s = 0, seen_s = 0;
  for (const AttemptTick& tick : attempt.ticks) {
    if (!tick.is_cutting() || !tick.is_contact_hidden) continue;
    (*tick.is_contact_hidden ? hidden_s : seen_s) += tick.dt_s;
  }
  return 100 * ratio(hidden_s, hidden_s + seen_s);
}

constexpr const char* kZones =
    "10.1097/MAO.0000000000001398: experts press harder and remove faster far from structures";
constexpr const char* kProduct = "J Laryngol Otol 129:1091: the product peaks and then falls";
constexpr const char* kCrown = "prepCheck";
constexpr const char* kTeachers = "PMC3413455: no violation of the facial nerve";

void add_bone(std::vector<Measure>& all) {
  all.push_back({"target_removed_percent", "%",
                 "100 |R ∩ T| / |T|: R the voxels of removed bone, T those of the target's bone", "",
                 target_removed_percent});
  all.push_back({"removed_outside_mm3", "mm³",
                 "volume of R that is farther than keep.margin_mm from T, or within the bone to be kept", "",
                 removed_outside_mm3});
  all.push_back(
      {"removed_outside_percent", "%", "100 removed_outside_mm3 / volume of T", "", removed_outside_percent});
  all.push_back({"removed_mm3", "mm³",
                 "volume of R in whole voxels; the window and the recorded ticks count by density", "",
                 removed_mm3});
  all.push_back({"dice_percent", "%", "200 |R ∩ T| / (|R| + |T|)", "Dice 1945", dice_percent});
  all.push_back({"keep_removed_mm3", "mm³", "volume of R within the bone to be kept; empty without such bone",
                 "", keep_removed_mm3});
  const std::string over =
      "thickness of the bone between a structure and the space open from outside, {} over the structure's "
      "surface where milling thinned it by a voxel or more; empty beyond 8 mm";
  all.push_back(of_structure("thickness_left_min_mm", "mm", fmt::format(fmt::runtime(over), "least"), "",
                             thickness_left_min_mm, true));
  all.push_back(of_structure("thickness_left_median_mm", "mm", fmt::format(fmt::runtime(over), "median"), "",
                             thickness_left_median_mm, true));
}

void add_crown(std::vector<Measure>& all) {
  const std::string along =
      "distance between the crown's surface before and after, along its normal, {}; empty without [crown]";
  all.push_back({"reduction_median_mm", "mm",
                 fmt::format(fmt::runtime(along), "median over the target's surface"), kCrown,
                 [](const Attempt& a) { return share(crown_of(a).reductions_mm, 0.5); }});
  all.push_back({"reduction_p10_mm", "mm", fmt::format(fmt::runtime(along), "10th percentile"), kCrown,
                 [](const Attempt& a) { return share(crown_of(a).reductions_mm, 0.1); }});
  all.push_back({"taper_deg", "°",
                 "convergence of the axial walls: twice the median angle between wall and [crown] axis, over "
                 "walls within 30° of it",
                 kCrown, [](const Attempt& a) { return 2 * share(crown_of(a).wall_angles_deg, 0.5); }});
  all.push_back({"undercut_mm3", "mm³",
                 "volume of removed target bone below remaining bone, along [crown] axis", kCrown,
                 [](const Attempt& a) { return crown_of(a).undercut_mm3; }});
}

void add_contacts(std::vector<Measure>& all) {
  all.push_back(of_contact(
      "no_go_contacts", "",
      "contacts of the turning burr's surface with a structure; half a second without contact separates two",
      kTeachers, &Contacts::count));
  all.push_back(
      of_contact("no_go_contact_s", "s", "duration of all ticks with contact", kTeachers, &Contacts::time_s));
  all.push_back(of_contact("no_go_first_contact_s", "s", "time of the first tick with contact; empty if none",
                           kTeachers, &Contacts::first_s));
  all.push_back(of_contact("no_go_force_max_N", "N", "greatest force of the burr in contact; empty if none",
                           "PMC3413455: no excessive force near the facial nerve", &Contacts::force_max_N));
  all.push_back({"no_go_removed_mm3", "mm³", "volume of R within structures", kTeachers,
                 no_go_removed_of_all_mm3, Measure::Each::structure, no_go_removed_mm3});
  all.push_back(of_structure(
      "no_go_perforated", "",
      "1 if removed bone opened a passage through a structure, between spaces that were not connected within "
      "it before",
      "PMC3413455: no perforation",
      [](const Attempt& a, std::size_t n) {
        return is_cut_through(a.exercise->structures[n].voxels, *a.scan, a.after) ? 1.0 : 0.0;
      },
      false));
  all.push_back(of_contact("no_go_min_distance_mm", "mm",
                           "least distance of the burr's surface from a structure; negative if it was inside",
                           "Voormolen: 3 mm left every facial nerve undamaged, 1 and 2 mm did not",
                           &Contacts::min_distance_mm));
}

void add_work(std::vector<Measure>& all) {
  all.push_back({"duration_s", "s", "duration of all ticks", "", duration_s});
  all.push_back({"cutting_s", "s", "duration of all ticks that removed bone", "", cutting_s});
  all.push_back({"idle_s", "s", "duration_s - cutting_s", "", idle_s});
  all.push_back(
      {"strokes", "",
       "pieces of the path while cutting; one ends when the path, in steps of 0.5 mm, turns by more than "
       "90°, or after 0.1 s without cutting",
       "PMC7411937", strokes});
  all.push_back({"stroke_length_median_mm", "mm", "median length of strokes", "PMC3413455: broad strokes",
                 [](const Attempt& a) { return of_strokes(a, &Stroke::length_mm); }});
  all.push_back({"stroke_duration_median_s", "s", "median duration of strokes", "PMC7411937",
                 [](const Attempt& a) { return of_strokes(a, &Stroke::duration_s); }});
  const auto force = [](const Zone* zone, double part) {
    return [=](const Attempt& a) { return cutting_share(a, zone, &AttemptTick::force_N, part); };
  };
  all.push_back({"force_median_N", "N", "median force of the burr over the ticks that removed bone", "",
                 force(nullptr, 0.5)});
  all.push_back({"force_p95_N", "N", "95th percentile of that force", "", force(nullptr, 0.95)});
  for (const Zone* zone : {&kNear, &kMiddle, &kFar}) {
    const std::string where = zone == &kNear     ? "with the burr's surface less than 4 mm from a structure"
                              : zone == &kMiddle ? "4 to 8 mm from the nearest structure"
                                                 : "more than 8 mm from any structure";
    all.push_back({fmt::format("force_median_{}_N", zone->name), "N", "median force " + where, kZones,
                   force(zone, 0.5)});
    all.push_back({fmt::format("removal_rate_{}_mm3_s", zone->name), "mm³/s",
                   "bone of reference density removed " + where + ", per second of cutting there", kZones,
                   [zone](const Attempt& a) { return removal_rate_mm3_s(a, zone); }});
    all.push_back(
        {fmt::format("burr_radius_median_{}_mm", zone->name), "mm", "median burr radius " + where, kZones,
         [zone](const Attempt& a) { return cutting_share(a, zone, &AttemptTick::burr_radius_mm, 0.5); }});
  }
}

void add_course(std::vector<Measure>& all) {
  all.push_back({"step_s", "s",
                 "time from completion of the previous steps until done_percent of a step's bone was "
                 "removed; empty if it never was. Without a step: the sum",
                 "", steps_s, Measure::Each::step, step_s});
  all.push_back({"dice_peak_percent", "%",
                 "greatest Dice coefficient during the attempt; progress.csv has it over time", kProduct,
                 [](const Attempt& a) { return peak_of(a).dice_percent; }});
  all.push_back({"dice_peak_s", "s", "time of the greatest Dice coefficient", kProduct,
                 [](const Attempt& a) { return peak_of(a).time_s; }});
  all.push_back({"hidden_cutting_percent", "%",
                 "share of the cutting time with a recorded view in which bone or the picture's edge hid the "
                 "burr's contact",
                 "PMC3413455: visibility while removing bone", hidden_cutting_percent});
  all.push_back(
      {"view_changes", "",
       "how often the view began to turn, shift or zoom after half a second at rest; empty without views",
       "PMC3413455: use of the view", [](const Attempt& a) { return view_changes(a.views); }});
}

std::string limit_text(const ExerciseItem& item) {
  std::string text;
  if (item.at_least) text = fmt::format("at least {}", *item.at_least);
  if (item.at_most) text += fmt::format("{}at most {}", text.empty() ? "" : " and ", *item.at_most);
  return text;
}

bool is_met(const ExerciseItem& item, double value) {
  return (!item.at_least || value >= *item.at_least) && (!item.at_most || value <= *item.at_most);
}

// Adds a row for each item that limits the measure, or one without a limit.
void add_rows(std::vector<MeasuredValue>& rows, const Measure& measure, const std::string& part, double value,
              const Exercise& exercise) {
  MeasuredValue row{
      part.empty() ? measure.name : measure.name + "." + part, {}, measure.unit, "", {}, measure.source};
  if (std::isfinite(value)) row.value = value;
  bool is_limited = false;
  for (const ExerciseItem& item : exercise.items) {
    if (item.measure != measure.name || item.part != part) continue;
    MeasuredValue limited = row;
    limited.limit = limit_text(item);
    if (row.value) limited.is_met = is_met(item, *row.value);
    if (!item.source.empty()) limited.source = item.source;
    rows.push_back(std::move(limited));
    is_limited = true;
  }
  if (!is_limited) rows.push_back(std::move(row));
}

}  // namespace

const std::vector<Measure>& all_measures() {
  static const std::vector<Measure> all = [] {
    std::vector<Measure> measures;
    add_bone(measures);
    add_crown(measures);
    add_contacts(measures);
    add_work(measures);
    add_course(measures);
    return measures;
  }();
  return all;
}

const Measure* find_measure(std::string_view name) {
  const auto found = std::ranges::find(all_measures(), name, &Measure::name);
  return found == all_measures().end() ? nullptr : &*found;
}

std::vector<std::string> parts_of(const Measure& measure, const Exercise& exercise) {
  std::vector<std::string> names;
  if (measure.each == Measure::Each::structure)
    for (const NoGoStructure& structure : exercise.no_go) names.push_back(structure.name);
  if (measure.each == Measure::Each::step)
    for (std::size_t n = 1; n <= exercise.steps.size(); ++n) names.push_back(std::to_string(n));
  return names;
}

std::vector<std::string> measure_names() {
  std::vector<std::string> names;
  for (const Measure& measure : all_measures()) names.push_back(measure.name);
  return names;
}

std::string measures_table() {
  constexpr std::array<const char*, 3> kEach{"", "structure", "step"};
  std::string table = "| measure | unit | definition | for each | source |\n|---|---|---|---|---|\n";
  for (const Measure& measure : all_measures()) {
    table += fmt::format("| `{}` | {} | {} | {} | {} |\n", measure.name, measure.unit, measure.formula,
                         kEach[static_cast<std::size_t>(measure.each)], measure.source);
  }
  return table;
}

std::vector<MeasuredValue> measure_attempt(const Attempt& attempt) {
  const Exercise& exercise = attempt.exercise->exercise;
  std::vector<MeasuredValue> rows;
  for (const Measure& measure : all_measures()) {
    WorkProgress::done(1);
    add_rows(rows, measure, "", measure.value(attempt), exercise);
    const std::vector<std::string> parts = parts_of(measure, exercise);
    for (std::size_t n = 0; n < parts.size(); ++n)
      add_rows(rows, measure, parts[n], measure.value_at(attempt, n), exercise);
  }
  return rows;
}

void write_progress(const std::filesystem::path& path, const Attempt& attempt) {
  write_text_atomically(path, [&](std::ostream& out) {
    out << "time_s,target_removed_percent,removed_outside_mm3,dice_percent\n";
    for (const AttemptProgress& at : progress_of(attempt)) {
      out << fmt::format("{:.3f},{},{},{}\n", at.time_s, at.target_removed_percent, at.removed_outside_mm3,
                         at.dice_percent);
    }
  });
}

std::string csv_row(const MeasuredValue& row) {
  const std::string met = row.is_met ? *row.is_met ? "yes" : "no" : "";
  return fmt::format("{},{},{},{},{},{}", csv_field(row.measure),
                     row.value ? fmt::format("{}", *row.value) : "", row.unit, row.limit, met,
                     csv_field(row.source));
}

void write_measured(const std::filesystem::path& path, const std::vector<MeasuredValue>& rows) {
  write_text_atomically(path, [&](std::ostream& out) {
    out << "measure,value,unit,limit,met,source\n";
    for (const MeasuredValue& row : rows) out << csv_row(row) << "\n";
  });
}

}  // namespace osteomill
