#include "osteomill/report/write_report.h"

#include <ostream>

#include "osteomill/files/atomic_file.h"
#include "osteomill/report/label_section.h"
#include "osteomill/report/metric_table.h"
#include "osteomill/report/run_figures.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

DrawnGroup draw(const RunGroup& group, const fs::path& folder, const PageText& text) {
  DrawnGroup drawn{group, {}};
  const auto add = [&](const std::string& name, const fs::path& file, std::string caption) {
    const auto note = text.caption_notes.find(name);
    if (note != text.caption_notes.end()) caption += " " + note->second;
    drawn.figures[name] = {file, std::move(caption)};
  };
  if (const auto bone = draw_picture_figure(group, folder)) {
    // Smaller as PNG; curves and clouds stay sharp as SVG.
    add("bone", bone->png, "The bone before, and after each algorithm's run.");
  }
  add("force", draw_force_figure(group, folder).svg,
      "Magnitude of the force sent to the hand. The panels of a row have one scale. Each pixel's least and "
      "greatest are drawn, so no spike is lost. What is shaded, before 0 s, is not counted in the tables.");
  add("torque", draw_torque_figure(group, folder).svg,
      "Magnitude of the torque sent to the hand, about the burr's centre.");
  add("shaft", draw_shaft_figure(group, folder).svg,
      "Where the simulated tool's shaft points while it touches, in degrees from its mean direction and "
      "coloured by time. Each panel has a scale of its own.");
  add("removed", draw_removed_figure(group, folder).svg,
      "Bone removed since the milling began, in mm³ of bone of the reference density.");
  add("path", draw_path_figure(group, folder).svg, "Where the burr's centre was, along the scan's axes.");
  if (const auto labels = draw_label_figure(group, folder)) {
    add("labels", labels->svg, "What was removed of each label over time, in the labels' colours.");
  }
  add("rate", draw_rate_figure(group, folder).svg,
      "Compute time of each tick, the algorithm's and the milling's: CPU time where the trial ran in "
      "simulated time, else by the clock. A loop at 1000 Hz is late where it goes above the dashed line.");
  return drawn;
}

void write_summary_csv(const fs::path& path, const std::vector<RunGroup>& groups) {
  write_text_atomically(path, [&](std::ostream& out) {
    out << summary_columns() << '\n';
    for (const RunGroup& group : groups) {
      for (const MeasuredRun& run : group.runs) out << summary_fields(run) << '\n';
    }
  });
}

}  // namespace

fs::path write_report(const std::vector<RunGroup>& groups, const fs::path& out_dir, const PageText& text) {
  write_folder_atomically(out_dir, [&](const fs::path& beside) {
    create_folder(beside / "figures");
    write_summary_csv(beside / "summary.csv", groups);
    std::vector<DrawnGroup> drawn;
    for (const RunGroup& group : groups) drawn.push_back(draw(group, beside / "figures", text));
    write_text_atomically(beside / "report.html",
                          [&](std::ostream& out) { out << report_page(drawn, text); });
  });
  return out_dir / "report.html";
}

fs::path write_report(const std::vector<Recording>& recordings, const fs::path& out_dir) {
  return write_report(group_runs(recordings), out_dir);
}

}  // namespace osteomill
