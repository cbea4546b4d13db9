#include "osteomill/study/write_report.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/study/bone_page.h"
#include "osteomill/study/metric_table.h"

#include "report/milled_bones.h"
#include "report/report_parts.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr const char* kBoneId = "bone";

std::vector<const Recording*> all_recordings(const RunGroup& group) {
  std::vector<const Recording*> recordings;
  for (const MeasuredRun& run : group.runs) recordings.push_back(run.recording);
  return recordings;
}

Section notices(const std::vector<const Recording*>& recordings) {
  Section section;
  for (const Recording* recording : recordings) {
    const std::string name = recording->path.filename().string();
    if (!recording->complete) {
      section.notices.push_back(name + " is unfinished: the program ended before it closed the recording.");
    }
    if (recording->dropped > 0) {
      section.notices.push_back(
          fmt::format("{} lacks {} ticks: the buffer was full while recording.", name, recording->dropped));
    }
  }
  return section;
}

// Returns a section on differences between recordings that do not belong together.
std::vector<Section> differences(const std::vector<const Recording*>& recordings) {
  Table table = differences_table(recordings);
  if (table.rows.empty()) return {};
  return {
      {.title = "Differences between the recordings",
       .notices = {fmt::format(
           "These recordings differ in {}. The results may come from that as well as from the algorithms.",
           fmt::join(table.header.begin() + 1, table.header.end(), ", "))},
       .tables = {std::move(table)}}};
}

double seconds_of(const Recording& recording) {
  return recording.records.back().time_s - recording.records.front().time_s;
}

// Returns the duration of each phase, and the planned one if the recordings have it: "The milling took 12.9
// to 18.1 s (20 s asked for)".
std::string how_long(const RunGroup& group) {
  std::string text;
  for (const std::string& phase : group.phases()) {
    std::vector<double> seconds;
    for (const MeasuredRun* run : group.runs_of(phase)) seconds.push_back(seconds_of(*run->recording));
    const auto [least, most] = std::ranges::minmax(seconds);
    const auto asked_of = [&](const MeasuredRun& run) {
      return find_setting<double>(run.recording->description, "script." + phase);
    };
    const double* asked = asked_of(group.runs.front());
    const bool is_same = std::ranges::all_of(group.runs, [&](const MeasuredRun& run) {
      return asked != nullptr && asked_of(run) != nullptr && *asked_of(run) == *asked;
    });
    text += fmt::format(" {} took {}{:.3g} s{}.", phase.empty() ? "It" : "The " + phase,
                        most - least < 0.1 ? "" : fmt::format("{:.3g} to ", least), most,
                        is_same ? fmt::format(" ({:.3g} s asked for)", *asked) : "");
  }
  return text;
}

Section what_was_run(const RunGroup& group) {
  const std::vector<const Recording*> recordings = all_recordings(group);
  const RunDescription& d = recordings.front()->description;
  if (!differences_table(recordings).rows.empty())
    return {
        .title = "What was run",
        .paragraphs = {fmt::format("{} recordings, which differ as the first table shows.{} osteomill {}.",
                                   recordings.size(), how_long(group), d.program_version)}};
  return {.title = "What was run",
          .paragraphs = {
              fmt::format("Scan: {}, {} × {} × {} voxels of {:.4g} × {:.4g} × {:.4g} mm, bone above "
                          "{:.6g}. Tool: a burr of {:.4g} mm "
                          "radius on a shaft of {:.4g} mm radius and {:.4g} mm length. {} {} at {:.6g} "
                          "ticks a second, seed {}.{} osteomill {}{}.",
                          d.scan_name, d.dims[0], d.dims[1], d.dims[2], d.spacing_mm.x(), d.spacing_mm.y(),
                          d.spacing_mm.z(), d.isovalue, d.tool.burr_radius_mm, d.tool.shaft_radius_mm,
                          d.tool.shaft_length_mm, recordings.size(),
                          recordings.size() == 1 ? "recording" : "recordings", 1 / d.tick_period_s, d.seed,
                          how_long(group), d.program_version,
                          d.made.processor.empty() ? "" : " on " + d.made.processor),
              "Forces and torques are those sent to the hand, tick by tick."}};
}

struct RunFigure {
  const char* name;
  Figure (*draw)(const RunGroup&, const fs::path& folder);
  const char* caption;
};

// A topic of the report: its figures and the metrics shown with them, by column name.
struct Topic {
  const char* title;
  std::vector<RunFigure> figures;
  std::vector<const char*> columns;
};

const Topic kFelt[] = {
    {"Force",
     {{"force", draw_force_figure,
       "Magnitude of the force sent to the hand. The panels of a row share a scale, which need not begin at "
       "0. Each pixel shows its minimum and maximum, so no spike is lost."}},
     {"force_mean_N", "force_max_N", "force_hp_rms_N", "force_hp_share", "force_step_max_N"}},
    {"Torque",
     {{"torque", draw_torque_figure,
       "Magnitude of the torque sent to the hand, about the burr's centre, drawn like the force."}},
     {"torque_mean_Nmm", "torque_max_Nmm", "torque_hp_rms_Nmm", "torque_hp_share", "torque_step_max_Nmm"}},
    {"Shaft",
     {{"shaft", draw_shaft_figure,
       "Direction of the simulated tool's shaft while it touches, in degrees from its mean direction and "
       "coloured by time. Each panel has its own scale."}},
     {"shaft_spread_deg", "shaft_excursion_deg", "shaft_from_handle_deg"}},
    {"Path and bone removed",
     {{"removed", draw_removed_figure,
       "Bone removed since the milling began, in mm³ of bone of the reference density."},
      {"path", draw_path_figure,
       "Position of the burr's centre along the scan's axes. Each panel has its own scale."}},
     {"removed_mm3", "removal_mm3_per_s", "path_mm", "burr_excursion_mm", "contact_share",
      "burr_contact_share", "shaft_contact_share"}}};
const Topic kTimes{
    "How long the ticks took",
    {{"rate", draw_rate_figure,
      "Compute time of each tick, for haptics and milling: CPU time if the trial ran in simulated time, "
      "otherwise wall-clock time. A loop at 1000 Hz is late where the curve is above the dashed line."}},
    {"steps", "tick_us_median", "tick_us_p99", "tick_us_max", "rate_hz"}};

// Returns a sentence on the parts of the curves that the tables exclude.
std::string excluded_ticks_text(const RunGroup& group) {
  const auto longest = std::ranges::max_element(
      group.runs, {}, [](const MeasuredRun& run) { return run.metrics.counted_from_s; });
  const double before_s = longest->metrics.counted_from_s;
  if (before_s == 0)
    return " Forces, torques and shaft directions without contact are not counted in the tables.";
  return fmt::format(
      " The tables do not count forces, torques and shaft directions without contact, nor the shaded time "
      "before 0 s in which the hand settles into its hold: at most {}, with {}.",
      shown_time(before_s), longest->algorithm.label);
}

CaptionedFigure drawn(const RunFigure& figure, const RunGroup& group, const PageText& text,
                      const fs::path& folder) {
  std::string caption = figure.caption;
  if (figure.name == kFelt[0].figures[0].name) caption += excluded_ticks_text(group);
  if (const auto note = text.caption_notes.find(figure.name); note != text.caption_notes.end())
    caption += " " + note->second;
  return {figure.draw(group, folder).svg, std::move(caption)};
}

std::vector<MetricLine> lines_of(const Topic& topic) {
  std::vector<MetricLine> lines;
  for (const char* column : topic.columns) {
    const Field<RunMetrics>& figure = metric(column);
    lines.push_back({label_of(figure), [&figure](const MeasuredRun& run) -> Cell {
                       const double value = figure.get(run.metrics);
                       if (!std::isnan(value)) return shown(value);
                       // Missing contact does not explain why no bone was cut.
                       return figure.name == "removal_mm3_per_s"
                                  ? shown(value)
                                  : Cell(contact_words(run.metrics.contact), CellStyle::words);
                     }});
  }
  return lines;
}

Table metrics_table(const RunGroup& group, const std::vector<MetricLine>& lines) {
  Table table{{""}, {{"not reached"}}, true};
  for (const MeasuredRun& run : group.runs) {
    table.header.push_back(run.phase.empty() ? run.algorithm.label : run.phase + "\n" + run.algorithm.label);
    table.rows.front().emplace_back(run.not_reached, CellStyle::words);
  }
  // Goals that were not reached come before all compared figures.
  if (std::ranges::all_of(group.runs, &std::string::empty, &MeasuredRun::not_reached)) table.rows.clear();
  for (const MetricLine& line : lines) {
    std::vector<Cell> row{line.label};
    for (const MeasuredRun& run : group.runs) row.push_back(line.cell(run));
    // The paper does not cover all algorithms.
    if (std::ranges::any_of(std::span(row).subspan(1), [](const Cell& cell) { return !cell.text().empty(); }))
      table.rows.push_back(std::move(row));
  }
  return table;
}

Section topic_section(const Topic& topic, const RunGroup& group, const PageText& text, const fs::path& folder,
                      const std::vector<MetricLine>& further = {}) {
  std::vector<MetricLine> lines = lines_of(topic);
  lines.insert(lines.end(), further.begin(), further.end());
  Section section{.title = topic.title};
  for (const RunFigure& figure : topic.figures) section.figures.push_back(drawn(figure, group, text, folder));
  section.tables = {metrics_table(group, lines)};
  return section;
}

bool has_setting(const RunGroup& group, std::string_view key) {
  return std::any_of(group.runs.begin(), group.runs.end(), [&](const MeasuredRun& run) {
    return find_setting<std::string>(run.recording->description, key) != nullptr;
  });
}

std::vector<Section> pictures_section(const RunGroup& group, const fs::path& folder, bool is_in_3d) {
  Section section{.title = "The bone before and after", .id = kBoneId};
  if (is_in_3d)
    section.paragraphs = {"Drag to rotate, scroll or pinch to zoom. The list selects whose bone is shown."};
  if (const auto bone = draw_picture_figure(group, folder)) {
    // Smaller as PNG; curves and clouds stay sharp as SVG.
    section.figures = {{bone->png, "The bone before, and after each algorithm's run."}};
  } else if (has_setting(group, kPicturesKey)) {
    section.notices = {"No pictures of the bone: OpenGL was not available when this was recorded."};
  } else if (!is_in_3d) {
    return {};
  }
  return {section};
}

Section labels_section(const RunGroup& group, const fs::path& folder) {
  std::optional<Section> labels = label_section(group);
  if (!labels) return {};
  // The figure follows the table.
  if (const auto figure = draw_label_figure(group, folder)) {
    labels->parts = {
        {.figures = {{figure->svg, "Bone removed from each label over time, in the labels' colours."}}}};
  }
  return *labels;
}

double spindle_s(const Recording& recording) {
  double on_s = 0;
  for (const TickRecord& record : recording.records) on_s += record.spindle_on ? record.dt_s : 0;
  return on_s;
}

// Returns a summary of a session for the person who held the tool.
std::string session_in_words(const MeasuredRun& run) {
  const RunMetrics& m = run.metrics;
  const auto& records = run.recording->records;
  const std::string put_back =
      m.put_back_mm3 > 0 ? fmt::format("; {:.1f} mm³ were restored", m.put_back_mm3) : "";
  const std::string text = fmt::format(
      "{}{}: {:.1f} s, of which the spindle ran for {:.1f} s. The burr went {:.0f} mm, and {:.1f} mm³ of "
      "bone were removed{}. ",
      run.algorithm.label, run.phase.empty() ? "" : ", " + run.phase,
      records.back().time_s - records.front().time_s, spindle_s(*run.recording), m.path_mm, m.removed_mm3,
      put_back);
  if (!is_enough_contact(m.contact.any)) {
    return text + fmt::format("The tool {}, too little to say what was felt.", contact_words(m.contact));
  }
  std::vector<std::string> means, greatest;
  for (const auto& [felt, unit] : {std::pair(&m.force_N, "N"), std::pair(&m.torque_Nmm, "N mm")}) {
    if (std::isnan(felt->mean)) continue;
    means.push_back(fmt::format("{:.2g} {}", felt->mean, unit));
    greatest.push_back(fmt::format("{:.2g} {}", felt->max, unit));
  }
  if (means.empty()) {
    return text + fmt::format("The tool touched for {:.0f} % of the time, too little to say what was felt.",
                              100 * m.contact.any);
  }
  return text +
         fmt::format(
             "The tool touched for {:.0f} % of the time, the shaft for {:.0f} %; while it did, the hand "
             "felt {} on average, at most {}.",
             100 * m.contact.any, 100 * m.contact.shaft, fmt::join(means, " and "),
             fmt::join(greatest, " and "));
}

Section sessions_in_words(const RunGroup& group) {
  Section section;
  for (const MeasuredRun& run : group.runs) section.paragraphs.push_back(session_in_words(run));
  return section;
}

Section how_to_repeat(const std::vector<const Recording*>& recordings) {
  std::vector<std::string> commands;
  for (const Recording* recording : recordings) {
    const std::string* command = find_setting<std::string>(recording->description, kCommandLineKey);
    if (command == nullptr || command->empty()) continue;
    if (std::find(commands.begin(), commands.end(), *command) == commands.end()) commands.push_back(*command);
  }
  return {.title = "How to repeat this",
          .paragraphs = {commands.empty() ? "With the settings above; the recordings contain no command."
                                          : "With the same seed, forces, poses and removed bone are the "
                                            "same; compute times depend on the machine."},
          .commands = commands};
}

// Puts the bones into a page, as far as there is room.
void put_bones(Page& page, const RunGroup& group, const ScanOf& scan_of) {
  constexpr std::size_t kMostBytes = 5'000'000, kScriptBytes = 900'000;
  const std::size_t bytes = html(page).size() + kScriptBytes;
  const MilledBones bones = milled_bones(group, scan_of, kMostBytes - std::min(bytes, kMostBytes));
  const auto section = std::ranges::find(page.sections, kBoneId, &Section::id);
  section->notices.insert(section->notices.end(), bones.notices.begin(), bones.notices.end());
  if (bones.data.is_null()) {
    section->paragraphs.clear();
    return;
  }
  put_data(page, bones.data);
  page.scripts.push_back(
      "Osteomill.showBone(document.getElementById(\"bone\"), document.querySelector(\"#bone figure\"))");
}

Page report_page(const RunGroup& group, const PageText& text, const ScanOf& scan_of, const fs::path& folder) {
  const std::vector<const Recording*> recordings = all_recordings(group);
  std::vector<Section> sections{notices(recordings)};
  const auto add = [&](const std::vector<Section>& more) {
    sections.insert(sections.end(), more.begin(), more.end());
  };
  add(differences(recordings));
  sections.push_back(text.opening ? *text.opening : sessions_in_words(group));
  add(pictures_section(group, folder, scan_of != nullptr));
  for (const Topic& topic : kFelt) sections.push_back(topic_section(topic, group, text, folder));
  sections.push_back(labels_section(group, folder));
  add(text.sections);
  sections.push_back(topic_section(kTimes, group, text, folder, text.further_times));
  Section run = what_was_run(group);
  run.paragraphs.insert(run.paragraphs.end(), text.about_the_run.begin(), text.about_the_run.end());
  add({run, {.title = "Settings", .tables = {settings_table(recordings)}}, how_to_repeat(recordings)});
  Page page{.title = text.title, .sections = std::move(sections)};
  if (scan_of) put_bones(page, group, scan_of);
  return page;
}

void write_summary_csv(const fs::path& path, const RunGroup& group) {
  write_text_atomically(path, [&](std::ostream& out) {
    out << summary_columns() << '\n';
    for (const MeasuredRun& run : group.runs) out << summary_fields(run) << '\n';
  });
}

}  // namespace

fs::path write_report(const RunGroup& group, const fs::path& out_dir, const ScanOf& scan_of,
                      const std::function<PageText(const fs::path&)>& text) {
  return write_page(out_dir, "report.html", [&](const fs::path& beside) {
    write_summary_csv(beside / "summary.csv", group);
    return report_page(group, text(beside / "figures"), scan_of, beside / "figures");
  });
}

fs::path write_report(const std::vector<Recording>& recordings, const fs::path& out_dir,
                      const ScanOf& scan_of) {
  return write_report(group_runs(recordings), out_dir, scan_of);
}

}  // namespace osteomill
