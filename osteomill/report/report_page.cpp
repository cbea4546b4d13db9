#include "osteomill/report/report_page.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "osteomill/report/html.h"
#include "osteomill/report/label_section.h"
#include "osteomill/report/metric_table.h"
#include "osteomill/report/settings_table.h"

namespace osteomill {

namespace {

std::vector<const Recording*> all_recordings(const std::vector<DrawnGroup>& groups) {
  std::vector<const Recording*> recordings;
  for (const DrawnGroup& drawn : groups) {
    for (const MeasuredRun& run : drawn.group.runs) recordings.push_back(run.recording);
  }
  return recordings;
}

std::string notice(const std::string& text) {
  return "<p class=\"notice\">" + html_escaped(text) + "</p>\n";
}

// What a reader must know before believing the rest.
std::string notices(const std::vector<const Recording*>& recordings) {
  std::string html;
  const RunDescription& first = recordings.front()->description;
  for (const Recording* recording : recordings) {
    const RunDescription& d = recording->description;
    const std::string name = recording->path.filename().string();
    if (!recording->complete) {
      html += notice(name + " is unfinished: the program ended before it closed the recording.");
    }
    if (recording->dropped > 0) {
      html += notice(fmt::format("{} lacks {} ticks for which there was no room while recording.", name,
                                 recording->dropped));
    }
    if (d.scan_name != first.scan_name || d.dims != first.dims || d.isovalue != first.isovalue) {
      html += notice(name + " is of another scan or isovalue than " +
                     recordings.front()->path.filename().string() + "; compare them with care.");
    }
  }
  return html;
}

std::string what_was_run(const std::vector<const Recording*>& recordings) {
  const RunDescription& d = recordings.front()->description;
  double seconds = 0;
  for (const Recording* recording : recordings) {
    seconds = std::max(seconds, recording->records.back().time_s - recording->records.front().time_s);
  }
  return html_paragraph(fmt::format(
             "Scan: {}, {} × {} × {} voxels of {:.4g} × {:.4g} × {:.4g} mm, bone above "
             "{:.6g}. Tool: a burr of {:.4g} mm "
             "radius on a shaft of {:.4g} mm radius and {:.4g} mm length. {} {} of up to "
             "{:.4g} s at {:.6g} ticks a "
             "second, seed {}. osteomill {}.",
             d.scan_name, d.dims[0], d.dims[1], d.dims[2], d.spacing_mm.x(), d.spacing_mm.y(),
             d.spacing_mm.z(), d.isovalue, d.tool.burr_radius_mm, d.tool.shaft_radius_mm,
             d.tool.shaft_length_mm, recordings.size(), recordings.size() == 1 ? "recording" : "recordings",
             seconds, 1 / d.tick_period_s, d.seed, d.program_version)) +
         html_paragraph("What is reported is what was sent to the hand at every tick.");
}

// What a reader wants to know at once: figures and the metrics beside them.
struct Topic {
  const char* title;
  std::vector<const char*> figures;
  std::vector<MetricTable> tables;
};

const std::vector<Topic>& felt_topics() {
  static const std::vector<Topic> topics{{"Force", {"force"}, {MetricTable::force}},
                                         {"Torque", {"torque"}, {MetricTable::torque}},
                                         {"Shaft", {"shaft"}, {MetricTable::shaft}},
                                         {"Path and bone removed", {"removed", "path"}, {MetricTable::path}}};
  return topics;
}

std::string cell(const Metric& metric, const MeasuredRun& run) {
  const double value = metric(run.metrics);
  if (!std::isnan(value)) return fmt::format(fmt::runtime(metric.format), value);
  return metric.table == MetricTable::times ? "not measured" : contact_words(run.metrics.contact);
}

std::vector<MetricLine> lines_of(const Topic& topic) {
  std::vector<MetricLine> lines;
  for (const MetricTable table : topic.tables) {
    for (const Metric& metric : all_metrics()) {
      if (metric.table != table) continue;
      lines.push_back(
          {with_unit(metric.label, metric), [&metric](const MeasuredRun& run) { return cell(metric, run); }});
    }
  }
  return lines;
}

std::string metrics_table(const RunGroup& group, const std::vector<MetricLine>& lines) {
  HtmlTable table{{""}, {}, true};
  for (const MeasuredRun& run : group.runs) {
    const std::string segment = run.segment.empty() ? "" : html_escaped(run.segment) + "<br>";
    table.header.push_back(segment + html_escaped(run.algorithm.label));
  }
  for (const MetricLine& line : lines) {
    table.rows.push_back({line.label});
    for (const MeasuredRun& run : group.runs) table.rows.back().push_back(line.cell(run));
  }
  return html_table(table);
}

std::string mode_heading(const DrawnGroup& drawn, const std::vector<DrawnGroup>& groups) {
  return groups.size() > 1 ? fmt::format("<h3>Mode {}</h3>\n", name_of(drawn.group.mode)) : "";
}

std::string topic_section(const Topic& topic, const std::vector<DrawnGroup>& groups,
                          const std::vector<MetricLine>& further = {}) {
  std::vector<MetricLine> lines = lines_of(topic);
  lines.insert(lines.end(), further.begin(), further.end());
  std::string html = fmt::format("<h2>{}</h2>\n", topic.title);
  for (const DrawnGroup& drawn : groups) {
    html += mode_heading(drawn, groups);
    for (const char* name : topic.figures) {
      const CaptionedFigure& figure = drawn.figures.at(name);
      html += html_figure(figure.files.svg, figure.caption);
    }
    html += metrics_table(drawn.group, lines);
  }
  return html;
}

// In the place of the pictures.
std::string missing_pictures(const RunGroup& group) {
  for (const MeasuredRun& run : group.runs) {
    for (const RunSetting& setting : run.recording->description.settings) {
      if (setting.key != kPicturesKey) continue;
      return notice("No pictures of the bone: OpenGL could not be had when this was recorded.");
    }
  }
  return "";
}

// Pictures of the bone are smaller as PNG; curves and clouds stay sharp as SVG.
std::string pictures_section(const std::vector<DrawnGroup>& groups) {
  std::string html;
  for (const DrawnGroup& drawn : groups) {
    const auto bone = drawn.figures.find("bone");
    const std::string shown = bone == drawn.figures.end()
                                  ? missing_pictures(drawn.group)
                                  : html_figure(bone->second.files.png, bone->second.caption);
    if (!shown.empty()) html += mode_heading(drawn, groups) + shown;
  }
  return html.empty() ? "" : "<h2>The bone before and after</h2>\n" + html;
}

// Of a scan with labels.
std::string labels_section(const std::vector<DrawnGroup>& groups) {
  std::string html;
  for (const DrawnGroup& drawn : groups) {
    const std::string text = label_section(drawn.group);
    if (text.empty()) continue;
    html += mode_heading(drawn, groups) + text;
    const auto figure = drawn.figures.find("labels");
    if (figure != drawn.figures.end()) html += html_figure(figure->second.files.svg, figure->second.caption);
  }
  return html;
}

double spindle_s(const Recording& recording) {
  double on_s = 0;
  for (const TickRecord& record : recording.records) on_s += record.spindle_on ? record.dt_s : 0;
  return on_s;
}

// What a session was, to whoever held the tool.
std::string session_in_words(const MeasuredRun& run) {
  const RunMetrics& m = run.metrics;
  const auto& records = run.recording->records;
  const std::string put_back =
      m.put_back_mm3 > 0 ? fmt::format("; {:.1f} mm³ were put back", m.put_back_mm3) : "";
  const std::string text = fmt::format(
      "{}{}: {:.1f} s, of which the spindle ran for {:.1f} s. The burr went {:.0f} mm, and {:.1f} mm³ of "
      "bone were removed{}. ",
      run.algorithm.label, run.segment.empty() ? "" : ", " + run.segment,
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

std::string sessions_in_words(const std::vector<DrawnGroup>& groups) {
  std::string html;
  for (const DrawnGroup& drawn : groups) {
    for (const MeasuredRun& run : drawn.group.runs) html += html_paragraph(session_in_words(run));
  }
  return html;
}

std::string how_to_repeat(const std::vector<const Recording*>& recordings) {
  std::vector<std::string> commands;
  for (const Recording* recording : recordings) {
    for (const RunSetting& setting : recording->description.settings) {
      const std::string* command = std::get_if<std::string>(&setting.value);
      if (setting.key != kCommandLineKey || command == nullptr || command->empty()) continue;
      if (std::find(commands.begin(), commands.end(), *command) == commands.end())
        commands.push_back(*command);
    }
  }
  std::string html = "<h2>How to repeat this</h2>\n";
  if (commands.empty())
    return html + html_paragraph("With the settings above; the recordings name no command.");
  html += html_paragraph(
      "With the same seed, forces, poses and removed bone come out the same; compute times are those "
      "of the machine.");
  html += "<pre>";
  for (const std::string& command : commands) html += html_escaped(command) + "\n";
  return html + "</pre>\n";
}

}  // namespace

std::string html_paragraph(const std::string& text) {
  return text.empty() ? "" : "<p>" + html_escaped(text) + "</p>\n";
}

std::string report_page(const std::vector<DrawnGroup>& groups, const PageText& text) {
  const std::vector<const Recording*> recordings = all_recordings(groups);
  std::string body = notices(recordings) + (text.opening.empty() ? sessions_in_words(groups) : text.opening);
  body += pictures_section(groups);
  for (const Topic& topic : felt_topics()) body += topic_section(topic, groups);
  body += labels_section(groups);
  const Topic times{"How long the ticks took", {"rate"}, {MetricTable::times, MetricTable::rate}};
  body += text.sections + topic_section(times, groups, text.further_times);
  body += "<h2>What was run</h2>\n" + what_was_run(recordings);
  body += "<h2>Settings</h2>\n" + html_table(settings_table(recordings)) + how_to_repeat(recordings);
  return html_page(text.title, body);
}

}  // namespace osteomill
