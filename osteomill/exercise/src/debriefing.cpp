#include "osteomill/exercise/debriefing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/csv_field.h"
#include "osteomill/base/input_error.h"
#include "osteomill/base/temporary_folder.h"
#include "osteomill/exercise/recorded_exercise.h"
#include "osteomill/study/bone_page.h"
#include "osteomill/visual/bone_picture.h"
#include "osteomill/visual/image.h"
#include "osteomill/volume/bone_densities.h"

#include "debrief/assets.h"
#include "debrief/bodies.h"
#include "debrief/course.h"

namespace osteomill {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kUnnamed = "without a name";

// Maximum for all bodies of a page together; they take 2.6 MB.
constexpr std::size_t kPageVertices = 110000;
constexpr const char *kThisWay = "this attempt", *kFirstWay = "the original";

Page page_with(std::string title, std::vector<Section> sections, const json& data) {
  Page page{.title = std::move(title), .sections = std::move(sections)};
  put_data(page, data);
  page.style += debrief_css();
  page.scripts.push_back(debrief_js());
  return page;
}

void write_html(const fs::path& path, const Page& page) {
  write_text_atomically(path, [text = html(page)](std::ostream& out) { out << text; });
}

bool is_item(const MeasuredValue& row) {
  return !row.limit.empty();
}

Cell mark_cell(const MeasuredValue& row) {
  if (row.limit.empty()) return {};
  if (!row.is_met) return {"– not measured", CellStyle::faint};
  return *row.is_met ? Cell("✓ met", CellStyle::agrees) : Cell("✗ not met", CellStyle::differs);
}

std::string value_text(const MeasuredValue& row) {
  return row.value ? fmt::format("{}{}{}", shown(*row.value), row.unit.empty() ? "" : " ", row.unit) : "–";
}

// Returns a value with its mark below.
Cell marked_cell(const MeasuredValue& row) {
  Cell cell{{{value_text(row), CellStyle::strong}}};
  if (is_item(row)) cell.pieces.push_back({"\n"});
  for (Cell::Piece& piece : mark_cell(row).pieces) cell.pieces.push_back(std::move(piece));
  return cell;
}

// Returns the corresponding row; both attempts are of the same exercise.
const MeasuredValue& row_of(const DebriefedAttempt& attempt, const DebriefedAttempt& own,
                            const MeasuredValue& row) {
  return attempt.rows[static_cast<std::size_t>(&row - own.rows.data())];
}

// Returns the values of a measure in those attempts that have one.
std::vector<double> values_of(const std::vector<DebriefedAttempt>& attempts, const std::string& measure) {
  std::vector<double> values;
  for (const DebriefedAttempt& attempt : attempts) {
    const auto row = std::ranges::find(attempt.rows, measure, &MeasuredValue::measure);
    if (row != attempt.rows.end() && row->value) values.push_back(*row->value);
  }
  return values;
}

std::string range_text(const std::vector<double>& values) {
  if (values.empty()) return "–";
  const auto [least, most] = std::ranges::minmax(values);
  return least == most ? shown(least) : fmt::format("{} to {}", shown(least), shown(most));
}

Section items_section(const DebriefedAttempt& own, const DebriefPeers& peers) {
  Section section{.title = "Items", .id = "items"};
  const bool has_first = peers.first != nullptr;
  Table table{has_first ? std::vector<std::string>{"item", kThisWay, kFirstWay, "threshold", "source"}
                        : std::vector<std::string>{"item", "mark", "value", "threshold", "source"}};
  if (!peers.experts.empty()) table.header.push_back(fmt::format("experts ({})", peers.experts.size()));
  for (const MeasuredValue& row : own.rows) {
    if (!is_item(row)) continue;
    std::vector<Cell>& cells = table.rows.emplace_back(std::vector<Cell>{row.measure});
    if (has_first) {
      cells.push_back(marked_cell(row));
      cells.push_back(marked_cell(row_of(peers.first->measured, own, row)));
    } else {
      cells.push_back(mark_cell(row));
      cells.emplace_back(value_text(row), CellStyle::strong);
    }
    cells.emplace_back(row.limit);
    cells.emplace_back(row.source);
    if (!peers.experts.empty()) cells.emplace_back(range_text(values_of(peers.experts, row.measure)));
  }
  if (table.rows.empty()) {
    section.paragraphs = {"The exercise has no items."};
  } else {
    section.tables = {std::move(table)};
  }
  return section;
}

// Compares with the earlier attempts, once there are enough to estimate their spread.
std::vector<Section> spread_sections(const DebriefedAttempt& own, const DebriefPeers& peers) {
  if (peers.before.empty()) return {};
  Section section{.title = fmt::format(
                      "Compared with the previous {}",
                      peers.before.size() == 1 ? "attempt" : fmt::format("{} attempts", peers.before.size())),
                  .id = "spread"};
  Table table{{"measure", "now", "previous mean", "previous spread", "outside the spread"}};
  for (const MeasuredValue& row : own.rows) {
    const std::vector<double> before = values_of(peers.before, row.measure);
    if (!row.value || before.empty() ||
        (is_item(row) && &row != &*std::ranges::find(own.rows, row.measure, &MeasuredValue::measure)))
      continue;
    const Spread spread = spread_of(before);
    std::vector<Cell> cells{row.measure, value_text(row), shown(spread.mean), "–",
                            Cell("too few attempts", CellStyle::faint)};
    if (!std::isnan(spread.width)) {
      cells[3] = "± " + shown(spread.width);
      cells[4] =
          std::abs(*row.value - spread.mean) > spread.width ? Cell("yes", CellStyle::strong) : Cell("no");
    }
    table.rows.push_back(std::move(cells));
  }
  section.paragraphs = {
      "The spread is how much attempts differ without any change: the next one would be within it in 19 of "
      "20 cases. It takes four previous attempts."};
  section.tables = {std::move(table)};
  return {std::move(section)};
}

std::vector<Section> zone_sections(const DebriefedAttempt& own, const DebriefPeers& peers) {
  Section section{.title = "By distance from the nearest structure", .id = "zones"};
  Table table{{"while cutting", "under 4 mm", "4 to 8 mm", "over 8 mm"}};
  const std::vector<std::pair<std::string, std::string>> measures = {
      {"force_median_{}_N", "force, median"},
      {"removal_rate_{}_mm3_s", "removal rate"},
      {"burr_radius_median_{}_mm", "burr radius, median"}};
  bool is_empty = true;
  for (const auto& [name, words] : measures) {
    std::vector<Cell> mine{words}, theirs{words + ", experts"};
    for (const char* zone : {"near", "middle", "far"}) {
      const std::string measure = fmt::format(fmt::runtime(name), zone);
      const auto row = std::ranges::find(own.rows, measure, &MeasuredValue::measure);
      mine.emplace_back(row == own.rows.end() ? "–" : value_text(*row));
      is_empty = is_empty && (row == own.rows.end() || !row->value);
      theirs.emplace_back(range_text(values_of(peers.experts, measure)));
    }
    table.rows.push_back(std::move(mine));
    if (!peers.experts.empty()) table.rows.push_back(std::move(theirs));
  }
  if (is_empty) return {};
  section.tables = {std::move(table)};
  return {std::move(section)};
}

Section measures_section(const DebriefedAttempt& own, const DebriefPeers& peers) {
  Section section{.title = "All measures", .id = "measures"};
  Table table{{"measure", "value"}};
  if (peers.first) table.header.emplace_back(kFirstWay);
  if (!peers.experts.empty()) table.header.emplace_back("experts");
  table.header.insert(table.header.end(), {"definition", "source"});
  for (const MeasuredValue& row : own.rows) {
    const Measure* measure = find_measure(row.measure.substr(0, row.measure.find('.')));
    std::vector<Cell>& cells = table.rows.emplace_back(std::vector<Cell>{row.measure, value_text(row)});
    if (peers.first) cells.emplace_back(value_text(row_of(peers.first->measured, own, row)));
    if (!peers.experts.empty()) cells.emplace_back(range_text(values_of(peers.experts, row.measure)));
    cells.emplace_back(measure == nullptr ? "" : measure->formula);
    cells.emplace_back(row.source);
  }
  section.tables = {std::move(table)};
  return section;
}

std::string who_and_when(const DebriefedAttempt& own) {
  std::string text = own.recording.empty() ? "" : own.recording + ", ";
  text += own.date_utc;
  if (own.has_guidance) text += ", with guidance shown at its beginning";
  return text + ".";
}

Section about_section(const Exercise& exercise, const DebriefedAttempt& own, const DebriefPeers& peers) {
  Section section;
  if (!own.is_complete)
    section.notices.push_back("The recording is unfinished: the program ended before it closed it.");
  if (!exercise.task.empty()) section.paragraphs.push_back(exercise.task);
  section.paragraphs.push_back(who_and_when(own));
  if (!peers.original_missing_reason.empty())
    section.notices.push_back("The recording from which this one branches off is not shown: " +
                              peers.original_missing_reason);
  if (peers.first)
    section.paragraphs.push_back(fmt::format(
        "It branches off from {} at {:.3f} s. The original is that recording to its end, this attempt what "
        "was done from there.",
        peers.first->measured.recording.empty() ? "another recording" : peers.first->measured.recording,
        peers.first->from.time_s));
  return section;
}

// Draws the bone at the end for browsers without WebGL; returns nothing if OpenGL is not available here.
std::vector<CaptionedFigure> still_of(const Attempt& attempt, const std::shared_ptr<const LabelMap>& colours,
                                      const TemporaryFolder& work) {
  const PlacedExercise& exercise = *attempt.exercise;
  Volume bone = attempt.after;
  bone.set_labels(colours);
  const Vec3 across_W = exercise.outward_W.unitOrthogonal();
  const Vec3 entry_W = exercise.exercise.entry_W_mm.value_or(target_ball(exercise).centre_W);
  try {
    const Camera camera = camera_above(bone, entry_W, -exercise.outward_W, across_W);
    const Image picture =
        bone_picture(bone, estimate_densities(*attempt.scan).reference, camera, {1120, 1120});
    write_png(work / "bone.png", averaged_down(picture, 2));
  } catch (const std::runtime_error&) {
    return {};
  }
  return {{work / "bone.png",
           "The bone at the end: target green, bone to be kept blue, structures red to violet."}};
}

// `work` must outlive the page.
Page attempt_page(const Attempt& attempt, const Recording& recording, const DebriefedAttempt& own,
                  const DebriefPeers& peers, const TemporaryFolder& work) {
  const PlacedExercise& exercise = *attempt.exercise;
  const auto colours = colours_of(exercise);
  const auto name_of = [](const DebriefedAttempt& one) {
    return one.recording.empty() ? "RECORDING" : one.recording;
  };
  json data;
  put_view(data, target_ball(exercise), exercise.outward_W);
  put_course(data, attempt, recording, name_of(own));
  if (peers.first) {
    put_original_attempt(data, *peers.first, name_of(peers.first->measured));
    add_bodies(data, peers.first->attempt, *colours, kPageVertices / 2, kFirstWay);
    add_bodies(data, attempt, *colours, kPageVertices / 2, kThisWay);
  } else {
    add_bodies(data, attempt, *colours, kPageVertices);
  }
  data["experts"] = json::array();
  for (const DebriefedAttempt& expert : peers.experts) data["experts"].push_back(curve_of(expert.progress));

  std::vector<Section> sections{about_section(exercise.exercise, own, peers), items_section(own, peers)};
  for (Section& section : spread_sections(own, peers)) sections.push_back(std::move(section));
  sections.push_back(
      {.title = "The bone",
       .id = "bone",
       .paragraphs = {"Drag to rotate, scroll or pinch to zoom. Press a mark to see what happened there."},
       .figures = still_of(attempt, colours, work)});
  sections.push_back({.title = "The course",
                      .id = "course",
                      .paragraphs = {"Press or drag to go to a time. Each point has the greatest force and "
                                     "the least distance of its interval."}});
  for (Section& section : zone_sections(own, peers)) sections.push_back(std::move(section));
  sections.push_back(measures_section(own, peers));
  std::string title = exercise.exercise.title;
  if (!own.trainee.empty()) title += ": " + own.trainee;
  return page_with(std::move(title), std::move(sections), data);
}

std::string name_of(const DebriefedAttempt& attempt) {
  return attempt.trainee.empty() ? kUnnamed : attempt.trainee;
}

// Returns the attempts of each person, sorted by name and time.
std::map<std::string, std::vector<DebriefedAttempt>> by_person(
    const std::vector<DebriefedAttempt>& attempts) {
  std::map<std::string, std::vector<DebriefedAttempt>> people;
  for (const DebriefedAttempt& attempt : attempts) people[name_of(attempt)].push_back(attempt);
  for (auto& [name, theirs] : people) std::ranges::stable_sort(theirs, {}, &DebriefedAttempt::date_utc);
  return people;
}

}  // namespace

DebriefedAttempt debriefed(const Attempt& attempt, const Recording& recording) {
  DebriefedAttempt done;
  done.recording = recording.path.string();
  done.date_utc = recording.description.made.date_utc;
  if (const auto exercise = recorded_exercise(recording.description)) {
    done.trainee = exercise->trainee;
    done.has_guidance = exercise->has_guidance;
  }
  done.is_complete = recording.complete;
  done.rows = measure_attempt(attempt);
  done.progress = progress_of(attempt);
  return done;
}

namespace {

std::vector<DebriefedAttempt> expert_attempts(const PlacedExercise& placed, const Volume& scan) {
  const Exercise& exercise = placed.exercise;
  std::vector<fs::path> paths;
  const auto take = [&](const Region& region) {
    for (const Shape& shape : region.shapes) {
      const auto* recorded = std::get_if<RecordedShape>(&shape);
      if (recorded == nullptr) continue;
      for (const fs::path& path : recorded->recordings) {
        if (std::ranges::find(paths, exercise.file.parent_path() / path) == paths.end())
          paths.push_back(exercise.file.parent_path() / path);
      }
    }
  };
  take(exercise.target);
  if (exercise.keep) take(*exercise.keep);
  for (const ExerciseStep& step : exercise.steps) take(step.region);
  std::vector<DebriefedAttempt> experts;
  for (const fs::path& path : paths) {
    const Recording recording = read_recording_chain(path);
    experts.push_back(debriefed(make_attempt(placed, scan, recording), recording));
  }
  return experts;
}

// Returns null if the recording does not branch off from another one.
std::shared_ptr<OriginalAttempt> original_attempt_of(const Attempt& attempt, const Recording& recording) {
  const auto from = branch_point(recording.description);
  if (!from) return nullptr;
  const fs::path folder = recording.path.parent_path();
  fs::path path = folder / from->recording;
  if (!fs::exists(path)) path = folder / path.filename();
  const Recording first = read_recording_chain(path);
  const auto& records = first.records;
  if (from->ticks > records.size() || records[from->ticks - 1].time_s != from->time_s)
    throw InputError(path.string(), "does not match the beginning of " + recording.path.string());
  Attempt whole = make_attempt(*attempt.exercise, *attempt.scan, first);
  DebriefedAttempt measured = debriefed(whole, first);
  return std::make_shared<OriginalAttempt>(OriginalAttempt{std::move(whole), std::move(measured), *from});
}

}  // namespace

DebriefPeers load_peers(const Attempt& attempt, const Recording& recording) {
  DebriefPeers peers;
  try {
    peers.first = original_attempt_of(attempt, recording);
  } catch (const InputError& error) {
    peers.original_missing_reason = error.what();
  }
  peers.experts = expert_attempts(*attempt.exercise, *attempt.scan);
  return peers;
}

Spread spread_of(const std::vector<double>& before) {
  constexpr std::size_t kFewest = 4;
  Spread spread{0, std::numeric_limits<double>::quiet_NaN()};
  const auto count = static_cast<double>(before.size());
  for (const double value : before) spread.mean += value / count;
  if (before.size() < kFewest) return spread;
  double squares = 0;
  for (const double value : before) squares += (value - spread.mean) * (value - spread.mean);
  // Quantile of Student's t for 95 %, expanded around the normal quantile 1.96 (Abramowitz and Stegun
  // 26.7.5).
  const double free = count - 1, z = 1.959964, z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  const double t = z + (z3 + z) / (4 * free) + (5 * z5 + 16 * z3 + 3 * z) / (96 * free * free) +
                   (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * free * free * free);
  spread.width = t * std::sqrt(squares / free * (1 + 1 / count));
  return spread;
}

void write_debriefing(const fs::path& folder, const Attempt& attempt, const Recording& recording,
                      const DebriefedAttempt& own, const DebriefPeers& peers) {
  const TemporaryFolder work;
  write_folder_atomically(folder, [&](const fs::path& beside) {
    write_measured(beside / "debrief.csv", own.rows);
    write_progress(beside / "progress.csv", attempt);
    write_html(beside / "debrief.html", attempt_page(attempt, recording, own, peers, work));
  });
}

void write_class_debriefing(const fs::path& folder, const Exercise& exercise,
                            const std::vector<DebriefedAttempt>& attempts,
                            const std::vector<std::string>& unread) {
  const auto people = by_person(attempts);
  Section summary{.title = "Names", .id = "people"};
  Table names{{"name", "attempts", "first", "last", "target removed over time; the last attempt in blue"}};
  Section items{.title = "Items", .id = "items"};
  Table values{{"name", "attempt", "date"}};
  for (const MeasuredValue& row : attempts.front().rows)
    if (is_item(row)) values.header.push_back(fmt::format("{} ({})", row.measure, row.limit));
  json data;
  data["curves"] = json::array();
  for (const auto& [name, theirs] : people) {
    names.rows.push_back(
        {name, std::to_string(theirs.size()), theirs.front().date_utc, theirs.back().date_utc, {}});
    data["curves"].push_back(json::array());
    for (std::size_t n = 0; n < theirs.size(); ++n) {
      data["curves"].back().push_back(curve_of(theirs[n].progress));
      values.rows.push_back({name, std::to_string(n + 1), theirs[n].date_utc});
      for (const MeasuredValue& row : theirs[n].rows)
        if (is_item(row)) values.rows.back().push_back(marked_cell(row));
    }
  }
  summary.tables = {std::move(names)};
  items.tables = {std::move(values)};
  Section about;
  for (const std::string& line : unread) about.notices.push_back("Not included: " + line);
  if (!exercise.task.empty()) about.paragraphs = {exercise.task};
  const Page page = page_with(exercise.title, {about, summary, items}, data);
  write_folder_atomically(folder, [&](const fs::path& beside) {
    write_text_atomically(beside / "debrief.csv", [&](std::ostream& out) {
      out << "name,attempt,date_utc,recording,measure,value,unit,limit,met,source\n";
      for (const auto& [name, theirs] : people) {
        for (std::size_t n = 0; n < theirs.size(); ++n) {
          for (const MeasuredValue& row : theirs[n].rows)
            out << fmt::format("{},{},{},{},{}\n", csv_field(name), n + 1, theirs[n].date_utc,
                               csv_field(theirs[n].recording), csv_row(row));
        }
      }
    });
    write_html(beside / "debrief.html", page);
  });
}

}  // namespace osteomill
