#include "report/report_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <type_traits>

#include <fmt/format.h>

#include "osteomill/base/csv_field.h"
#include "osteomill/base/input_error.h"
#include "osteomill/base/parse_number.h"
#include "osteomill/session/milling_setup.h"
#include "osteomill/session/tick_counts.h"
#include "osteomill/study/metric_table.h"
#include "osteomill/visual/image.h"

namespace osteomill {

namespace {

// Width of a panel in two columns; limits the size of the SVG, which embeds the pictures.
constexpr int kPanelWidth_px = 560;

Image shrunk(const Recording& recording, const RunPicture& picture) {
  const std::optional<Image> image = decode_png(picture.png);
  if (!image) {
    throw InputError(recording.path.string(),
                     fmt::format("the picture '{}' is not a complete PNG of reasonable size", picture.name));
  }
  const int factor = (image->width + kPanelWidth_px - 1) / kPanelWidth_px;
  // A picture with fewer rows than this factor would vanish.
  return averaged_down(*image, std::min(factor, image->height));
}

struct Panel {
  std::string label;
  const Recording* recording;
  const RunPicture* picture;
};

const RunPicture* picture_named(const Recording& recording, std::string_view name) {
  for (const RunPicture& picture : recording.pictures) {
    if (picture.name == name) return &picture;
  }
  return nullptr;
}

// Returns the bone before, for each scan, then after each algorithm, from its first phase with a picture.
std::vector<Panel> panels_of(const RunGroup& group) {
  std::vector<Panel> panels, along_the_entry;
  for (const MeasuredRun& run : group.runs) {
    const auto is_shown = [&](const Panel& panel) {
      return panel.recording->description.scan_hash == run.recording->description.scan_hash;
    };
    const RunPicture* before = picture_named(*run.recording, kPictureBefore);
    if (before == nullptr || std::ranges::any_of(panels, is_shown)) continue;
    const std::string of = panels.empty() ? "" : ", another scan";
    panels.push_back({"Before" + of, run.recording, before});
  }
  for (const AlgorithmId& algorithm : group.algorithms()) {
    for (const std::string& phase : group.phases()) {
      const MeasuredRun* run = group.find(algorithm.name, phase);
      const RunPicture* after = run ? picture_named(*run->recording, kPictureAfter) : nullptr;
      if (after == nullptr) continue;
      // If the picture before belongs to an earlier part of the session, this part's removed volume does not
      // account for the whole difference between the two.
      const bool whole = picture_named(*run->recording, kPictureBefore) != nullptr;
      panels.push_back(
          {whole ? fmt::format("After {} ({:.1f} mm³ removed)", algorithm.label, run->metrics.removed_mm3)
                 : std::string("At the end"),
           run->recording, after});
      if (const RunPicture* along = picture_named(*run->recording, kPictureAlong))
        along_the_entry.push_back(
            {fmt::format("{}, seen along the entry", algorithm.label), run->recording, along});
      break;
    }
  }
  panels.insert(panels.end(), along_the_entry.begin(), along_the_entry.end());
  return panels;
}

}  // namespace

std::string run_name(const MeasuredRun& run) {
  return run.phase.empty() ? run.algorithm.label : run.algorithm.label + ", " + run.phase;
}

std::optional<Figure> draw_picture_figure(const RunGroup& group, const std::filesystem::path& folder) {
  const std::vector<Panel> panels = panels_of(group);
  if (panels.empty()) return std::nullopt;
  const int columns = panels.size() == 1 ? 1 : 2;
  const int rows = (static_cast<int>(panels.size()) + columns - 1) / columns;
  std::vector<Image> pictures;
  for (const Panel& panel : panels) pictures.push_back(shrunk(*panel.recording, *panel.picture));
  const int wide = columns == 1 ? 800 : kPanelWidth_px;
  const int high = std::clamp(wide * pictures[0].height / pictures[0].width, 200, 1000) + 40;
  FigureScript script{"bone", static_cast<double>(rows) * high, static_cast<double>(columns) * wide};
  script.body =
      "set multiplot\nunset tics\nunset border\nset size ratio -1\nset lmargin 0.5\nset rmargin 0.5\n"
      "set tmargin 2\nset bmargin 0.3\nset autoscale xfix\nset autoscale yfix\n";
  for (std::size_t n = 0; n < panels.size(); ++n) {
    const std::vector<unsigned char>& png = encode_png(pictures[n]);
    const int column = static_cast<int>(n) % columns;
    const int row = static_cast<int>(n) / columns;
    script.body += fmt::format(
        "set origin {:.4f},{:.4f}\nset size {:.4f},{:.4f}\nset title {} offset 0,-0.5 noenhanced\n"
        "plot {} binary filetype=png with rgbimage notitle\n",
        static_cast<double>(column) / columns, 1.0 - (row + 1.0) / rows, 1.0 / columns, 1.0 / rows,
        gnuplot_quoted(panels[n].label),
        script.data({reinterpret_cast<const char*>(png.data()), png.size()}));
  }
  return draw_figure(script, folder);
}

namespace {

LabelCount count_of(const Recording& recording) {
  LabelCount count(recording.description.labels);
  for (const TickRecord& record : recording.records) count.add(record);
  return count;
}

Cell name_with_colour(const Label& label) {
  std::vector<Cell::Piece> pieces{{"■", CellStyle::plain, hex_colour(label)}, {" " + label.name}};
  if (label.no_go) pieces.insert(pieces.end(), {{" "}, {"no-go", CellStyle::differs}});
  return pieces;
}

std::vector<Cell> cells(const MeasuredRun& run, const Label& label, const LabelCount::Entry& entry) {
  const double all_mm3 = run.metrics.removed_mm3;
  return {run_name(run),
          name_with_colour(label),
          fmt::format("{:.3f}", entry.removed_mm3),
          all_mm3 > 0 ? fmt::format("{:.1f}", 100 * entry.removed_mm3 / all_mm3) : "",
          fmt::format("{:.2f}", entry.first_s),
          fmt::format("{:.2f}", entry.last_s),
          fmt::format("{:.2f}", entry.time_s),
          fmt::format("{:.2f}", entry.force_mean_N),
          fmt::format("{:.2f}", entry.force_max_N)};
}

// Adds a row for each label that this run cut or touched, no-go labels first.
void add_rows(const MeasuredRun& run, Table& table) {
  const LabelCount count = count_of(*run.recording);
  for (const bool no_go : {true, false}) {
    for (std::size_t n = 0; n < count.labels().size(); ++n) {
      const LabelCount::Entry& entry = count.entries()[n];
      if (count.labels()[n].no_go == no_go && entry.contacts > 0)
        table.rows.push_back(cells(run, count.labels()[n], entry));
    }
  }
}

// Returns the curve of a label's removed volume over time: both ends, and a point for each further
// two-hundredth.
std::string curve_of(const Recording& recording, LabelMap::LabelIndex label, double all_mm3) {
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

// Returns gnuplot commands for one run's panel; empty if the run removed no labelled bone.
std::string panel(const MeasuredRun& run, FigureScript& figure) {
  const LabelCount count = count_of(*run.recording);
  double all_mm3 = 0;
  for (const LabelCount::Entry& entry : count.entries()) all_mm3 += entry.removed_mm3;
  std::string plot;
  for (std::size_t n = 0; n < count.labels().size(); ++n) {
    if (!(count.entries()[n].removed_mm3 > 0)) continue;
    const std::string curve = curve_of(*run.recording, static_cast<LabelMap::LabelIndex>(n + 1), all_mm3);
    plot += fmt::format("{}{} with steps lw 2 lc rgb '{}' title {}", plot.empty() ? "plot " : ", ",
                        figure.data(curve), hex_colour(count.labels()[n]),
                        gnuplot_quoted(count.labels()[n].name));
  }
  if (plot.empty()) return plot;
  return fmt::format("set title {}\n{}\n", gnuplot_quoted(run_name(run)), plot);
}

}  // namespace

std::optional<Section> label_section(const RunGroup& group) {
  Table table{{"Run", "Label", "Removed (mm³)", "of the run's bone (%)", "First at (s)", "Last at (s)",
               "Time in it (s)", "Force of the burr, mean (N)", "… greatest (N)"},
              {},
              true};
  bool any = false;
  for (const MeasuredRun& run : group.runs) {
    any = any || !run.recording->description.labels.empty();
    add_rows(run, table);
  }
  if (!any) return std::nullopt;
  if (table.rows.empty()) return Section{.title = "Labels", .paragraphs = {"The burr cut no labelled bone."}};
  return Section{.title = "Labels",
                 .paragraphs = {"Bone cut from each structure of the label map; a no-go label counts as "
                                "soon as the turning burr touches it."},
                 .tables = {table}};
}

std::optional<Figure> draw_label_figure(const RunGroup& group, const std::filesystem::path& folder) {
  constexpr int kPanel_px = 360;
  FigureScript script{"labels", 0};
  std::string panels;
  int count = 0;
  for (const MeasuredRun& run : group.runs) {
    const std::string one = panel(run, script);
    panels += one;
    count += one.empty() ? 0 : 1;
  }
  if (count == 0) return std::nullopt;
  const int columns = std::min(count, 2), rows = (count + columns - 1) / columns;
  script.height_px = static_cast<double>(kPanel_px) * rows;
  script.body = fmt::format(
      "set multiplot layout {},{}\nset border 3 lc rgb '#444444'\nset tics nomirror out scale 0.6\n"
      "set grid lc rgb '#dddddd' lt 1 lw 0.7\nset key left top noenhanced\nset xlabel 'Time (s)'\n"
      "set ylabel 'Removed (mm³)'\nset yrange [0:*]\n{}",
      rows, columns, panels);
  return draw_figure(script, folder);
}

namespace {

std::string text_of(const std::string& text) {
  return text;
}
template <typename Value>
std::string text_of(const Value& value) {
  if constexpr (std::is_arithmetic_v<Value>)
    return fmt::format("{}", value);
  else
    return fmt::format("{}, {}, {}", value[0], value[1], value[2]);
}

// Returns the value as text; by name if it is a choice or a switch of the session.
std::string text_of(const RunSetting& setting) {
  const double* number = std::get_if<double>(&setting.value);
  const Field<SessionSettings>* field = find_field(fields_of<SessionSettings>(), setting.key);
  if (number != nullptr && field != nullptr) {
    if (auto name = field->name_of_value(*number)) return *std::move(name);
  }
  return std::visit([](const auto& value) { return text_of(value); }, setting.value);
}

// Returns both the description's own fields and its further settings.
std::vector<RunSetting> all_settings(const RunDescription& d) {
  std::vector<RunSetting> settings;
  visit_attributes(d, [&](const RunAttribute& of, const auto& value) {
    // A hash of 0 means no label map.
    const bool is_none = of.name == std::string_view("label_map_hash") && text_of(value) == "0";
    if (of.is_setting && !is_none) settings.push_back({of.name, text_of(value), ""});
  });
  for (const RunSetting& setting : d.settings) {
    if (setting.key == kCommandLineKey || setting.key == kNotReachedKey) continue;
    settings.push_back(setting);
    settings.back().value = text_of(setting);
    if (setting.key == kSamplePointsKey && std::get<std::string>(settings.back().value) == "0")
      settings.back().value = "created as the tool approaches";
  }
  return settings;
}

// Returns a unit with superscript digits: units in recordings are ASCII ("mm^3").
std::string raised(std::string unit) {
  for (const auto& [power, digit] : {std::pair("^2", "²"), std::pair("^3", "³")}) {
    if (const auto at = unit.find(power); at != std::string::npos) unit.replace(at, 2, digit);
  }
  return unit;
}

// Rounds a number to six significant digits; returns other text unchanged.
std::string rounded_number(const std::string& text) {
  const auto number = parse_number<double>(text);
  if (!number || (*number != 0 && text.find('.') == std::string::npos))
    return number && std::isinf(*number) ? "no limit" : text;
  return *number == 0 ? "0" : fmt::format("{:.6g}", *number);
}

// Rounds each of several comma-separated numbers.
std::string rounded(const std::string& text) {
  std::vector<std::string> numbers;
  for (const std::string_view number : csv_fields(text)) {
    if (!parse_number<double>(number)) return text;
    numbers.push_back(rounded_number(std::string(number)));
  }
  return fmt::format("{}", fmt::join(numbers, ", "));
}

struct SettingLine {
  std::string key;
  std::string unit;
  // One value per recording; nothing if the recording lacks the setting.
  std::vector<std::optional<std::string>> values;
};

std::vector<SettingLine> collect(const std::vector<const Recording*>& recordings) {
  std::vector<SettingLine> lines;
  for (std::size_t n = 0; n < recordings.size(); ++n) {
    for (const RunSetting& setting : all_settings(recordings[n]->description)) {
      const auto same = [&](const SettingLine& l) { return l.key == setting.key && l.unit == setting.unit; };
      auto line = std::find_if(lines.begin(), lines.end(), same);
      if (line == lines.end()) {
        lines.push_back({setting.key, setting.unit, {}});
        lines.back().values.resize(recordings.size());
        line = lines.end() - 1;
      }
      line->values[n] = std::get<std::string>(setting.value);
    }
  }
  return lines;
}

// Maximum number of values that a cell lists.
constexpr std::size_t kFew = 4;

std::string value_of(const SettingLine& line, const std::vector<const Recording*>& recordings) {
  if (std::all_of(line.values.begin(), line.values.end(),
                  [&](const auto& v) { return v == line.values[0]; })) {
    return line.values[0].value_or("");
  }
  std::map<AlgorithmId, std::optional<std::string>> by_algorithm;
  bool algorithm_decides = true;
  std::string each;
  std::size_t count = 0;
  for (std::size_t n = 0; n < recordings.size(); ++n) {
    const RunDescription& d = recordings[n]->description;
    const auto [entry, is_new] = by_algorithm.emplace(d.algorithm, line.values[n]);
    if (!is_new && entry->second != line.values[n]) algorithm_decides = false;
    if (line.values[n] && ++count <= kFew) {
      each += fmt::format("{}{}, {}: {}", each.empty() ? "" : "; ", name_of(d.algorithm), d.phase,
                          *line.values[n]);
    }
  }
  if (!algorithm_decides) return count > kFew ? fmt::format("{}; and {} others", each, count - kFew) : each;
  std::string text;
  for (const auto& [algorithm, value] : by_algorithm) {
    if (value) text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", name_of(algorithm), *value);
  }
  return text;
}

}  // namespace

Table settings_table(const std::vector<const Recording*>& recordings) {
  Table table{{"Setting", "Value", "Unit"}, {}};
  for (SettingLine& line : collect(recordings)) {
    for (std::optional<std::string>& value : line.values)
      if (value) value = rounded(*value);
    table.rows.push_back({line.key, value_of(line, recordings), raised(line.unit)});
  }
  return table;
}

namespace {

// Returns true for a setting of one algorithm, which is meaningless for another.
bool is_of_the_algorithm(const std::string& key) {
  return key == kSamplePointsKey || key.starts_with("algorithm.") || key.starts_with("probe.");
}

bool differs(const SettingLine& line, const std::vector<const Recording*>& recordings) {
  if (line.key == kComparisonKey || line.key == kPicturesKey) return false;
  for (std::size_t a = 0; a < recordings.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const RunDescription &first = recordings[a]->description, &second = recordings[b]->description;
      const bool comparable = !is_of_the_algorithm(line.key) || first.algorithm == second.algorithm;
      if (comparable && line.values[a] != line.values[b]) return true;
    }
  }
  return false;
}

}  // namespace

Table differences_table(const std::vector<const Recording*>& recordings) {
  Table table{{"Recording"}, {}};
  std::vector<SettingLine> lines = collect(recordings);
  std::erase_if(lines, [&](const SettingLine& line) { return !differs(line, recordings); });
  for (const SettingLine& line : lines) {
    table.header.push_back(with_unit(line.key, raised(line.unit)));
  }
  if (lines.empty()) return table;
  for (std::size_t n = 0; n < recordings.size(); ++n) {
    table.rows.push_back({recordings[n]->path.string()});
    for (const SettingLine& line : lines) table.rows.back().push_back(rounded(line.values[n].value_or("")));
  }
  return table;
}

}  // namespace osteomill
