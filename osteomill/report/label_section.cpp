#include "osteomill/report/label_section.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "osteomill/session/tick_counts.h"

namespace osteomill {

namespace {

LabelCount count_of(const Recording& recording) {
  LabelCount count(recording.description.labels);
  for (const TickRecord& record : recording.records) count.add(record);
  return count;
}

std::string run_name(const MeasuredRun& run) {
  return run.phase.empty() ? run.algorithm.label : run.algorithm.label + ", " + run.phase;
}

std::string name_with_colour(const Label& label) {
  const std::string text =
      fmt::format("<span style=\"color:{}\">&#9632;</span> {}", hex_colour(label), html_escaped(label.name));
  return label.no_go ? text + " <span class=\"differs\">no-go</span>" : text;
}

std::vector<std::string> cells(const MeasuredRun& run, const Label& label, const LabelCount::Entry& entry) {
  const double all_mm3 = run.metrics.removed_mm3;
  return {html_escaped(run_name(run)),
          name_with_colour(label),
          fmt::format("{:.3f}", entry.removed_mm3),
          all_mm3 > 0 ? fmt::format("{:.1f}", 100 * entry.removed_mm3 / all_mm3) : "",
          fmt::format("{:.2f}", entry.first_s),
          fmt::format("{:.2f}", entry.last_s),
          fmt::format("{:.2f}", entry.time_s),
          fmt::format("{:.2f}", entry.force_mean_N),
          fmt::format("{:.2f}", entry.force_max_N)};
}

// Its labels that were cut or touched, as rows: no-go ones first.
void add_rows(const MeasuredRun& run, HtmlTable& table) {
  const LabelCount count = count_of(*run.recording);
  for (const bool no_go : {true, false}) {
    for (std::size_t n = 0; n < count.labels().size(); ++n) {
      const LabelCount::Entry& entry = count.entries()[n];
      if (count.labels()[n].no_go == no_go && entry.contacts > 0)
        table.rows.push_back(cells(run, count.labels()[n], entry));
    }
  }
}

// Where it has gone up by a two-hundredth, and its ends.
std::string curve_of(const Recording& recording, LabelMap::Place label, double all_mm3) {
  const double first_s = recording.records.front().time_s;
  std::string data = "0 0\n";
  double removed_mm3 = 0, written_mm3 = 0;
  for (const TickRecord& record : recording.records) {
    for (const LabelCut& cut : record.label_cuts) {
      if (cut.label == label) removed_mm3 += cut.removed_mm3;
    }
    const bool last = &record == &recording.records.back();
    if (!last && removed_mm3 - written_mm3 < all_mm3 / 200) continue;
    data += fmt::format("{:.3f} {:.6g}\n", record.time_s - first_s, removed_mm3);
    written_mm3 = removed_mm3;
  }
  return data;
}

// gnuplot commands for one run's panel; empty where it removed nothing that has a label.
std::string panel(const MeasuredRun& run, std::size_t number, const TemporaryFolder& work) {
  const LabelCount count = count_of(*run.recording);
  double all_mm3 = 0;
  for (const LabelCount::Entry& entry : count.entries()) all_mm3 += entry.removed_mm3;
  std::string plot;
  for (std::size_t n = 0; n < count.labels().size(); ++n) {
    if (!(count.entries()[n].removed_mm3 > 0)) continue;
    const std::string file = fmt::format("labels-{}-{}.dat", number, n);
    write_figure_data(work / file, curve_of(*run.recording, static_cast<LabelMap::Place>(n + 1), all_mm3));
    plot += fmt::format("{}'{}' with steps lw 2 lc rgb '{}' title {}", plot.empty() ? "plot " : ", ", file,
                        hex_colour(count.labels()[n]), gnuplot_quoted(count.labels()[n].name));
  }
  if (plot.empty()) return plot;
  return fmt::format("set title {}\n{}\n", gnuplot_quoted(run_name(run)), plot);
}

}  // namespace

std::optional<PageSection> label_section(const RunGroup& group) {
  HtmlTable table{{"Run", "Label", "Removed (mm³)", "of the run's bone (%)", "First at (s)", "Last at (s)",
                   "In it for (s)", "Force of the burr, mean (N)", "… greatest (N)"},
                  {},
                  true};
  bool any = false;
  for (const MeasuredRun& run : group.runs) {
    any = any || !run.recording->description.labels.empty();
    add_rows(run, table);
  }
  if (!any) return std::nullopt;
  if (table.rows.empty())
    return PageSection{.title = "Labels", .paragraphs = {"The burr cut nothing that has a label."}};
  return PageSection{
      .title = "Labels",
      .paragraphs = {"What was cut of each structure of the label map; a no-go label counts as "
                     "soon as the turning burr touches it."},
      .tables = {table}};
}

std::optional<Figure> draw_label_figure(const RunGroup& group, const std::filesystem::path& folder) {
  constexpr int kPanel_px = 360;
  const TemporaryFolder work;
  std::string panels;
  int count = 0;
  for (std::size_t n = 0; n < group.runs.size(); ++n) {
    const std::string one = panel(group.runs[n], n, work);
    panels += one;
    count += one.empty() ? 0 : 1;
  }
  if (count == 0) return std::nullopt;
  const int columns = std::min(count, 2), rows = (count + columns - 1) / columns;
  FigureScript script{fmt::format("labels_{}", name_of(group.mode)), static_cast<double>(kPanel_px) * rows};
  script.body = fmt::format(
      "set multiplot layout {},{}\nset border 3 lc rgb '#444444'\nset tics nomirror out scale 0.6\n"
      "set grid lc rgb '#dddddd' lt 1 lw 0.7\nset key left top noenhanced\nset xlabel 'Time (s)'\n"
      "set ylabel 'Removed (mm³)'\nset yrange [0:*]\n{}",
      rows, columns, panels);
  return draw_figure(script, work, folder);
}

}  // namespace osteomill
