#include "osteomill/report/report_page.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "osteomill/report/html.h"
#include "osteomill/report/label_section.h"
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

MetricLine real_line(const char* label, const std::function<double(const RunMetrics&)>& value) {
  return {label, [value](const MeasuredRun& run) {
            const double number = value(run.metrics);
            return std::isnan(number) ? contact_words(run.metrics.contact) : fmt::format("{:.4g}", number);
          }};
}

MetricLine cpu_line(const char* label, double (*value)(const Distribution&)) {
  return {label, [value](const MeasuredRun& run) {
            const auto& cpu_us = run.metrics.cpu_us;
            return cpu_us ? fmt::format("{:.4g}", value(*cpu_us)) : "not measured";
          }};
}

std::vector<MetricLine> metric_lines() {
  using M = RunMetrics;
  return {
      {"Ticks", [](const MeasuredRun& run) { return fmt::format("{}", run.metrics.steps); }},
      real_line("Compute time of a step, median (µs)", [](const M& m) { return m.step_us.median; }),
      real_line("… 99th percentile (µs)", [](const M& m) { return m.step_us.p99; }),
      real_line("… greatest (µs)", [](const M& m) { return m.step_us.max; }),
      cpu_line("Work of a whole tick, CPU time, median (µs)", [](const Distribution& d) { return d.median; }),
      cpu_line("… 99th percentile (µs)", [](const Distribution& d) { return d.p99; }),
      cpu_line("… greatest (µs)", [](const Distribution& d) { return d.max; }),
      {"Haptic rate that a 1 kHz loop would hold (Hz)",
       [](const MeasuredRun& run) { return fmt::format("{:.1f}", run.metrics.rate_hz); }},
      real_line("In contact, share of the time", [](const M& m) { return m.contact.any; }),
      real_line("… with the burr", [](const M& m) { return m.contact.burr; }),
      real_line("… with the shaft", [](const M& m) { return m.contact.shaft; }),
      real_line("Force while in contact, mean (N)", [](const M& m) { return m.force_N.mean; }),
      real_line("… greatest (N)", [](const M& m) { return m.force_N.max; }),
      real_line("… above 20 Hz, rms (N)", [](const M& m) { return m.force_N.hp_rms; }),
      real_line("… greatest change in a tick (N)", [](const M& m) { return m.force_N.step_max; }),
      real_line("Torque while in contact, mean (N mm)", [](const M& m) { return m.torque_Nmm.mean; }),
      real_line("… greatest (N mm)", [](const M& m) { return m.torque_Nmm.max; }),
      real_line("… above 20 Hz, rms (N mm)", [](const M& m) { return m.torque_Nmm.hp_rms; }),
      real_line("… greatest change in a tick (N mm)", [](const M& m) { return m.torque_Nmm.step_max; }),
      real_line("Shaft direction, spread (degrees)", [](const M& m) { return m.shaft.spread_deg; }),
      real_line("… greatest excursion (degrees)", [](const M& m) { return m.shaft.excursion_deg; }),
      real_line("Bone removed in the phase (mm³)", [](const M& m) { return m.removed_mm3; })};
}

std::string metrics_table(const RunGroup& group, const std::vector<MetricLine>& further) {
  HtmlTable table{{""}, {}, true};
  for (const MeasuredRun& run : group.runs) {
    const RunDescription& d = run.recording->description;
    table.header.push_back(fmt::format("{}<br>{}", html_escaped(d.segment), html_escaped(d.algorithm.label)));
  }
  std::vector<MetricLine> lines = metric_lines();
  lines.insert(lines.end(), further.begin(), further.end());
  for (const MetricLine& line : lines) {
    table.rows.push_back({line.label});
    for (const MeasuredRun& run : group.runs) table.rows.back().push_back(line.cell(run));
  }
  return html_table(table);
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

std::string group_section(const DrawnGroup& drawn, const PageText& text) {
  const RunGroup& group = drawn.group;
  std::string html = fmt::format("<h2>Mode: {}</h2>\n", name_of(group.mode));
  html += html_paragraph(
      group.mode == Mode::paper
          ? "The algorithms as the paper has them."
          : "The paper's algorithms with this project's named improvements, so what the paper found "
            "wrong with one of them need not be wrong here.");
  if (text.about_group) html += text.about_group(group);
  html += "<h3>Figures of merit</h3>\n" + metrics_table(group, text.further_metrics);
  html += label_section(group);
  html += "<h3>Figures</h3>\n" + missing_pictures(group);
  for (const CaptionedFigure& figure : drawn.figures) {
    // Pictures of the bone are smaller as PNG, curves and clouds as SVG stay sharp.
    const bool photograph = figure.files.png.filename().string().starts_with("bone");
    html += html_figure(photograph ? figure.files.png : figure.files.svg, figure.caption);
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
  std::string body = html_paragraph(text.in_short);
  body += "<h2>What was run</h2>\n" + notices(recordings) + what_was_run(recordings) +
          html_paragraph(text.what_was_done) + text.sections;
  for (const DrawnGroup& drawn : groups) body += group_section(drawn, text);
  body += "<h2>Settings</h2>\n" + html_table(settings_table(recordings)) + how_to_repeat(recordings);
  return html_page(text.title, body);
}

}  // namespace osteomill
