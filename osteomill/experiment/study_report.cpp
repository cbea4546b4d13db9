#include "osteomill/experiment/study_report.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ostream.h>

#include "osteomill/experiment/conclusions.h"
#include "osteomill/experiment/findings_section.h"
#include "osteomill/experiment/study_maps.h"
#include "osteomill/experiment/study_section.h"
#include "osteomill/files/atomic_file.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// As RFC 4180 has it.
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string varied_fields(const StudyDesign& design, const StudySettings& settings) {
  std::string fields;
  for (const std::string& key : design.varied()) {
    const std::string* value = find_value(settings, key);
    fields += "," + (value == nullptr ? "" : csv_field(*value));
  }
  return fields;
}

std::string csv_head(const StudyDesign& design) {
  std::string head = list_head(design) + ",part";
  for (const StudyColumn& column : columns_of(design.test)) head += "," + column.name;
  return head + ",not_reached\n";
}

std::string csv_row(const StudyDesign& design, const StudySettings& settings, const TrialRow& row) {
  std::string line =
      fmt::format("{}{},{}", row.trial, varied_fields(design, settings), parts_of(design.test)[row.part]);
  for (const double value : row.values) line += std::isnan(value) ? "," : fmt::format(",{}", value);
  return line + "," + csv_field(row.not_reached) + "\n";
}

std::string text_of(const StudySettings& settings, std::string_view key, const char* otherwise) {
  const std::string* value = find_value(settings, key);
  return value == nullptr ? otherwise : *value;
}

// Rows that are compared hand by hand: those of the same bone, tool and all else that is set.
class FindingsByGroup {
 public:
  void add(const StudyDesign& design, const StudySettings& settings, const TrialRow& row) {
    std::string group;
    for (const std::string& key : design.varied()) {
      if (key == "seed" || key == "algorithm" || key == "mode" || key == "grip") continue;
      if (const std::string* value = find_value(settings, key))
        group += fmt::format("{}{} {}", group.empty() ? "" : ", ", key, *value);
    }
    StudyRow of_hand = milling_row(row);
    of_hand.seed = seed_of(settings);
    of_hand.grip = std::stod(text_of(settings, "grip", "1"));
    of_hand.run.algorithm =
        algorithm_named(text_of(settings, "algorithm", default_algorithm().id.name.c_str())).id;
    of_hand.run.mode = *mode_named(text_of(settings, "mode", "steady"));
    groups_[group].push_back(std::move(of_hand));
  }

  void add_sections(std::vector<PageSection>& sections, const fs::path& figures) const {
    std::size_t number = 0;
    for (const auto& [group, rows] : groups_) {
      const Study study(of_whole_hands(rows));
      PageSection section{.title = group.empty() ? "Over the hands" : "Over the hands: " + group,
                          .paragraphs = {what_was_compared(study, group.empty() ? "the same bone" : group)},
                          .points = conclusions(study),
                          .parts = {findings_section(study)}};
      for (const std::string_view phase : study.phases()) {
        const fs::path folder = figures / fmt::format("{}", number);
        create_folder(folder);
        section.figures.push_back({draw_study_figure(study, phase, folder).svg, "Every hand."});
      }
      sections.push_back(std::move(section));
      ++number;
    }
  }

 private:
  // Of a part of a study some hands have not yet tried all.
  static std::vector<StudyRow> of_whole_hands(std::vector<StudyRow> rows) {
    std::map<std::uint64_t, std::size_t> tried;
    std::size_t most = 0;
    for (const StudyRow& row : rows) most = std::max(most, ++tried[row.seed]);
    std::erase_if(rows, [&](const StudyRow& row) { return tried[row.seed] < most; });
    return rows;
  }

  std::map<std::string, std::vector<StudyRow>> groups_;
};

constexpr std::size_t kFewValues = 12;
using TriedValues = std::map<std::string, std::vector<std::string>>;

// One more than few stands for any number.
void note_tried(TriedValues& tried, const StudySettings& settings) {
  for (const auto& [key, value] : settings) {
    std::vector<std::string>& values = tried[key];
    if (values.size() <= kFewValues && std::find(values.begin(), values.end(), value) == values.end())
      values.push_back(value);
  }
}

HtmlTable options_table(const StudyDesign& design, const TriedValues& tried) {
  HtmlTable table{{"Option", "What was tried"}, {}};
  for (const auto& [key, values] : tried) {
    const std::string unit = text_of(design.units, key, "");
    std::string words;
    for (std::size_t n = 0; n < std::min(values.size(), kFewValues); ++n)
      words += (n == 0 ? "" : ", ") + values[n];
    table.rows.push_back({html_escaped(unit.empty() ? key : fmt::format("{} ({})", key, unit)),
                          html_escaped(values.size() > kFewValues ? words + " and others" : words)});
  }
  return table;
}

std::string share_text(std::size_t done, std::size_t all) {
  return fmt::format("{} of {} trials ({:.3g} %)", done, all,
                     100 * static_cast<double>(done) / static_cast<double>(all));
}

}  // namespace

std::string list_head(const StudyDesign& design) {
  std::string head = "trial";
  for (const std::string& key : design.varied()) head += "," + key;
  return head;
}

std::string list_row(const StudyDesign& design, std::size_t number) {
  return fmt::format("{}{}", number, varied_fields(design, design.trial(number)));
}

fs::path write_study_report(const StudyDesign& design, const StudyRecord& record, const fs::path& folder) {
  std::vector<MapOfStudy> maps;
  for (const StudyMap& map : design.maps) maps.emplace_back(design, map);
  TriedValues tried;
  FindingsByGroup findings;
  std::size_t done = 0;
  double cpu_s = 0;
  const fs::path out = folder / "report";
  write_folder_atomically(out, [&](const fs::path& beside) {
    write_text_atomically(beside / "trials.csv", [&](std::ostream& csv) {
      csv << csv_head(design);
      for (std::size_t number = 0; number < record.slices(); ++number) {
        const std::optional<Slice> slice = read_slice(folder, record, design.test, number);
        if (!slice) continue;
        done += record.size_of(number);
        cpu_s += slice->cpu_s;
        for (const TrialRow& row : slice->rows) {
          const StudySettings settings = design.trial(row.trial);
          csv << csv_row(design, settings, row);
          note_tried(tried, settings);
          for (MapOfStudy& map : maps) map.add(settings, row);
          if (design.findings) findings.add(design, settings, row);
        }
      }
    });
    if (done == 0) throw InputError(folder.string(), "has no trial that is done");
    create_folder(beside / "figures");
    PageSection opening{
        .paragraphs = {fmt::format("{}, test {}; {:.3g} h of CPU.", share_text(done, record.trials),
                                   name_of(design.test), cpu_s / 3600)},
        .tables = {options_table(design, tried)}};
    if (done < record.trials)
      opening.notices = {fmt::format("This is a part of the study: {}.", share_text(done, record.trials))};
    std::vector<PageSection> sections{std::move(opening)};
    PageSection drawn{.title = "Maps"};
    for (std::size_t n = 0; n < maps.size(); ++n) {
      if (maps[n].empty()) {
        drawn.notices.push_back(
            fmt::format("Map {}, {}: nothing was measured.", n + 1, design.maps[n].title));
        continue;
      }
      drawn.figures.push_back(
          {maps[n].draw(fmt::format("map_{}", n + 1), beside / "figures").svg, maps[n].caption()});
    }
    if (!maps.empty()) sections.push_back(std::move(drawn));
    if (design.findings) findings.add_sections(sections, beside / "figures");
    write_text_atomically(beside / "report.html", [&](std::ostream& page) {
      page << html_page(design.title.empty() ? "A study" : design.title, sections);
    });
  });
  return out / "report.html";
}

}  // namespace osteomill
