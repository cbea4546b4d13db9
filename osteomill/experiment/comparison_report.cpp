#include "osteomill/experiment/comparison_report.h"

#include <algorithm>
#include <optional>
#include <variant>

#include <fmt/format.h>

#include "osteomill/experiment/findings.h"
#include "osteomill/experiment/paper.h"
#include "osteomill/experiment/passivity_figure.h"
#include "osteomill/experiment/passivity_section.h"
#include "osteomill/experiment/study_figure.h"
#include "osteomill/experiment/study_section.h"
#include "osteomill/experiment/study_words.h"
#include "osteomill/experiment/trial_plan.h"
#include "osteomill/files/atomic_file.h"
#include "osteomill/report/html.h"
#include "osteomill/report/write_report.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

std::string findings_table(const std::vector<Finding>& findings) {
  HtmlTable table{{"The paper found", "Measured here", "Verdict", "Rule"}, {}};
  for (const Finding& f : findings) {
    const char* css = f.verdict == Verdict::agrees           ? "agrees"
                      : f.verdict == Verdict::does_not_agree ? "differs"
                                                             : "none";
    table.rows.push_back({html_escaped(f.paper_says), html_escaped(f.measured),
                          fmt::format("<span class=\"{}\">{}</span>", css, name_of(f.verdict)),
                          "agrees where " + html_escaped(f.rule)});
  }
  return html_table(table);
}

std::string about_group(const RunGroup& group) {
  const std::vector<Finding> findings = check_findings(group);
  std::string html;
  for (const std::string& text : plain_paragraphs(group, findings)) html += html_paragraph(text);
  return html + "<h3>The paper's findings</h3>\n" + findings_table(findings);
}

std::string paper_rate(const MeasuredRun& run) {
  const RunDescription& d = run.recording->description;
  const auto rate_hz = paper_mean_rate_hz(d.algorithm.name, d.segment);
  return rate_hz ? fmt::format("{:.0f}", *rate_hz) : "";
}

PageText page_text() {
  PageText text;
  text.title = "6-DOF haptic algorithms compared while milling bone";
  text.what_was_done =
      "While milling, the simulated hand moves the burr in until it touches, mills a hole and pushes the "
      "shaft "
      "against the hole's edge; while holding, it stands in the milled hole with the shaft against the wall "
      "and "
      "keeps as still as it can.";
  text.about_group = about_group;
  text.further_metrics = {{"Haptic rate in the paper, mean, on a Pentium 4 (Hz)", paper_rate}};
  text.caption_notes = {{"rate", "The paper's figure 6."},
                        {"force", "The paper's figure 7."},
                        {"torque", "The paper's figure 8."},
                        {"shaft", "The paper's figure 9."}};
  return text;
}

std::optional<double> matched_N_per_mm(const Recording& recording) {
  for (const RunSetting& setting : recording.description.settings) {
    if (setting.key != kMatchedStiffnessKey) continue;
    if (const double* felt_N_per_mm = std::get_if<double>(&setting.value)) return *felt_N_per_mm;
  }
  return std::nullopt;
}

std::string about_stiffness(const std::vector<Recording>& recordings) {
  const std::optional<double> felt_N_per_mm = matched_N_per_mm(recordings.front());
  const bool is_matched =
      felt_N_per_mm && std::all_of(recordings.begin(), recordings.end(), [&](const Recording& recording) {
        return matched_N_per_mm(recording) == felt_N_per_mm;
      });
  if (is_matched) {
    return fmt::format(
        "Stiffness is matched: each algorithm's was chosen so that a flat wall is felt as {:.3g} N/mm (the "
        "slope of the force over the depth about 0.5 N, pressed with the burr). How it resists turning, and "
        "what is felt of an edge or with the shaft, is not matched.",
        *felt_N_per_mm);
  }
  return "Stiffness is not matched: each algorithm has that of its own equations, and the hand feels another "
         "from each. What differs in force between them is partly this (compare --match-stiffness).";
}

void add_study(const Study& study, const fs::path& out_dir, PageText& page) {
  std::vector<CaptionedFigure> figures;
  for (const std::string_view phase : study.phases()) {
    figures.push_back(
        {draw_study_figure(study, phase, out_dir / "figures"),
         "Every hand of the study, by algorithm and mode; logarithmic where values lie far apart."});
  }
  page.in_short = study_in_two_sentences(study);
  page.sections += study_section(study, figures);
}

}  // namespace

bool are_of_comparison(const std::vector<Recording>& recordings) {
  return std::all_of(recordings.begin(), recordings.end(), [](const Recording& recording) {
    const auto& settings = recording.description.settings;
    return std::any_of(settings.begin(), settings.end(),
                       [](const RunSetting& setting) { return setting.key == kScriptEntryKey; });
  });
}

fs::path write_comparison_report(const std::vector<Recording>& recordings, const fs::path& out_dir,
                                 const ReportExtras& extras) {
  PageText text = page_text();
  if (!recordings.empty()) text.what_was_done += " " + about_stiffness(recordings);
  create_folder(out_dir / "figures");
  if (extras.study) {
    write_study_csv(out_dir / "study.csv", *extras.study);
    add_study(*extras.study, out_dir, text);
  }
  if (!extras.stability.empty()) {
    write_passivity_csv(out_dir / "stability.csv", extras.stability);
    text.sections +=
        passivity_section(extras.stability, draw_passivity_figure(extras.stability, out_dir / "figures"));
  }
  return write_report(recordings, out_dir, text);
}

}  // namespace osteomill
