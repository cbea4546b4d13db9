#include "osteomill/experiment/write_report.h"

#include <ostream>

#include "osteomill/experiment/report_page.h"
#include "osteomill/experiment/stability_figure.h"
#include "osteomill/experiment/stability_section.h"
#include "osteomill/experiment/study_figure.h"
#include "osteomill/experiment/study_section.h"
#include "osteomill/experiment/study_words.h"
#include "osteomill/files/atomic_file.h"
#include "osteomill/report/curve_figure.h"
#include "osteomill/report/metrics.h"
#include "osteomill/report/picture_figure.h"
#include "osteomill/report/run_groups.h"
#include "osteomill/report/shaft_figure.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

DrawnGroup draw(RunGroup group, const fs::path& folder) {
  std::vector<CaptionedFigure> figures;
  if (const auto bone = draw_picture_figure(group, folder)) {
    figures.push_back({*bone, "The bone before, and after each algorithm's run."});
  }
  figures.push_back(
      {draw_rate_figure(group, folder),
       "Haptic rate that the loop would hold, tick by tick (left), and the time that a tick's algorithm and "
       "milling took (right). The paper's figure 6."});
  figures.push_back(
      {draw_force_figure(group, folder),
       "Magnitude of the force sent to the hand. Each pixel's least and greatest are drawn, so no spike is "
       "lost. The paper's figure 7."});
  figures.push_back(
      {draw_torque_figure(group, folder),
       "Magnitude of the torque sent to the hand, about the burr's centre. The paper's figure 8."});
  figures.push_back(
      {draw_shaft_figure(group, folder),
       "Where the simulated tool's shaft points: a point on the unit sphere a tick, coloured by time. The "
       "panels of a phase have the same ranges; a compact cloud is a steady shaft. The paper's figure 9."});
  return {std::move(group), std::move(figures)};
}

std::vector<SummaryRow> summary_rows(const std::vector<RunGroup>& groups) {
  std::vector<SummaryRow> rows;
  for (const RunGroup& group : groups) {
    for (const MeasuredRun& run : group.runs) {
      const RunDescription& d = run.recording->description;
      rows.push_back({d.algorithm, d.mode, d.phase, run.metrics});
    }
  }
  return rows;
}

void add_study(const Study& study, const fs::path& out_dir, PageAdditions& page) {
  std::vector<CaptionedFigure> figures;
  for (const RunPhase phase : study.phases()) {
    figures.push_back(
        {draw_study_figure(study, phase, out_dir / "figures"),
         "Every hand of the study, by algorithm and mode; logarithmic where values lie far apart."});
  }
  page.in_short = study_in_two_sentences(study);
  page.sections += study_section(study, figures);
}

}  // namespace

fs::path write_report(const std::vector<Recording>& recordings, const fs::path& out_dir,
                      const ReportExtras& extras) {
  std::vector<RunGroup> groups = group_runs(recordings);
  create_folder(out_dir / "figures");
  // First, so that the numbers are there even where no figure can be drawn.
  write_summary_csv(out_dir / "summary.csv", summary_rows(groups));
  if (extras.study) write_study_csv(out_dir / "study.csv", *extras.study);
  if (!extras.stability.empty()) write_stability_csv(out_dir / "stability.csv", extras.stability);
  PageAdditions additions;
  if (extras.study) add_study(*extras.study, out_dir, additions);
  if (!extras.stability.empty()) {
    additions.sections +=
        stability_section(extras.stability, draw_stability_figure(extras.stability, out_dir / "figures"));
  }
  std::vector<DrawnGroup> drawn;
  for (RunGroup& group : groups) drawn.push_back(draw(std::move(group), out_dir / "figures"));
  const fs::path page = out_dir / "report.html";
  write_text_atomically(page, [&](std::ostream& out) { out << report_page(drawn, additions); });
  return page;
}

}  // namespace osteomill
