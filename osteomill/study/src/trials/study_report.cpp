#include "osteomill/study/study_report.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include <fmt/format.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/csv_field.h"
#include "osteomill/base/input_error.h"
#include "osteomill/study/metric_table.h"

#include "trials/findings_section.h"
#include "trials/study_answers.h"
#include "trials/study_figure.h"
#include "trials/study_maps.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

std::string csv_head(const StudyDesign& design) {
  return fmt::format("{},part{},not_reached\n", list_head(design), csv_names(columns_of(design.test)));
}

std::string csv_row(const StudyDesign& design, const TrialRow& row) {
  return fmt::format("{},{}{},{}\n", list_row(design, row.trial), parts_of(design.test)[row.part],
                     csv_values(columns_of(design.test), row), csv_field(row.run.not_reached));
}

std::string text_of(const StudySettings& settings, std::string_view key, const char* otherwise) {
  const std::string* value = find_value(settings, key);
  return value == nullptr ? otherwise : *value;
}

MeasuredRun run_of_hand(const StudySettings& settings, const TrialRow& row) {
  MeasuredRun run = row.run;
  run.algorithm = algorithm_named(text_of(settings, "algorithm", default_algorithm().id.name.c_str())).id;
  run.seed = seed_of(settings);
  run.grip = std::stod(text_of(settings, "grip", "1"));
  return run;
}

// Returns what the compared hands share: the bone, the tool, and everything else that varies except for hand
// and algorithm.
std::string group_of(const StudyDesign& design, const StudySettings& settings) {
  std::string group;
  for (const std::string& key : design.varied()) {
    if (key == "seed" || key == "algorithm" || key == "grip") continue;
    if (const std::string* value = find_value(settings, key))
      group += fmt::format("{}{} {}", group.empty() ? "" : ", ", key, *value);
  }
  return group;
}

// Drops hands that have not tried everything yet, in an unfinished study.
std::vector<MeasuredRun> drop_incomplete_hands(std::vector<MeasuredRun> rows) {
  std::map<std::uint64_t, std::size_t> tried;
  std::size_t most = 0;
  for (const MeasuredRun& row : rows) most = std::max(most, ++tried[row.seed]);
  std::erase_if(rows, [&](const MeasuredRun& row) { return tried[row.seed] < most; });
  return rows;
}

std::vector<Section> findings_sections(const StudyDesign& design, const std::vector<TrialRow>& all,
                                       const fs::path& figures) {
  std::map<std::string, std::vector<MeasuredRun>> groups;
  for (const TrialRow& row : all) {
    const StudySettings settings = design.trial(row.trial);
    groups[group_of(design, settings)].push_back(run_of_hand(settings, row));
  }
  std::vector<Section> sections;
  for (const auto& [group, rows] : groups) {
    const Study study(drop_incomplete_hands(rows));
    const fs::path folder = figures / fmt::format("{}", sections.size());
    create_folder(folder);
    Section& section =
        sections.emplace_back(Section{.title = group.empty() ? "Over the hands" : "Over the hands: " + group,
                                      .figures = draw_hands(study, folder),
                                      .tables = conclusions(study),
                                      .parts = {findings_section(study)}});
    if (const std::string few = sample_size_warning(study); !few.empty()) section.notices = {few};
    for (const std::string& text :
         {recommendation_text(study), comparison_sentence(study, group), table_explanation(study)})
      if (!text.empty()) section.paragraphs.push_back(text);
  }
  return sections;
}

Table options_table(const StudyDesign& design, const std::vector<TrialRow>& rows) {
  constexpr std::size_t kFewValues = 12;
  // Keeps one value more than is shown, to tell whether there are others.
  std::map<std::string, std::vector<std::string>> tried;
  for (const TrialRow& row : rows) {
    for (const auto& [key, value] : design.trial(row.trial)) {
      std::vector<std::string>& values = tried[key];
      if (values.size() <= kFewValues && std::ranges::find(values, value) == values.end())
        values.push_back(value);
    }
  }
  Table table{{"Option", "In these trials"}, {}};
  for (auto& [key, values] : tried) {
    const bool has_others = values.size() > kFewValues;
    if (has_others) values.pop_back();
    const std::string words = fmt::format("{}{}", fmt::join(values, ", "), has_others ? " and others" : "");
    table.rows.push_back({design.label_of(key), words});
  }
  return table;
}

Section maps_section(const StudyDesign& design, const std::vector<TrialRow>& rows, const fs::path& figures) {
  Section section{.title = "Maps"};
  for (std::size_t n = 1; n <= design.maps.size(); ++n) {
    const StudyMap& map = design.maps[n - 1];
    if (const auto drawn = draw_study_map(design, map, rows, fmt::format("map_{}", n), figures)) {
      section.figures.push_back(*drawn);
    } else {
      section.notices.push_back(fmt::format("Map {}, {}: nothing was measured.", n, map.title));
    }
  }
  return section;
}

std::set<std::size_t> unreached_trials(const std::vector<TrialRow>& rows) {
  std::set<std::size_t> trials;
  for (const TrialRow& row : rows)
    if (!row.run.not_reached.empty()) trials.insert(row.trial);
  return trials;
}

// Returns an empty text if all trials completed their test.
std::string unreached_words(std::size_t short_of, std::size_t done, Unreached unreached) {
  if (short_of == 0) return "";
  return fmt::format(" {} of the {} trials did not do all of their test; {}.", short_of, done,
                     unreached == Unreached::dropped
                         ? "they are left out of everything here"
                         : "they are included below (not_reached in trials.csv names them), and hatched in "
                           "every map of the part that they did not complete");
}

std::string share_text(std::size_t done, std::size_t all) {
  return fmt::format("{} of {} trials ({:.3g} %)", done, all,
                     100 * static_cast<double>(done) / static_cast<double>(all));
}

}  // namespace

std::string list_head(const StudyDesign& design) {
  std::string head = "trial";
  for (const std::string& key : design.varied()) head += "," + csv_field(design.label_of(key));
  return head;
}

std::string list_row(const StudyDesign& design, std::size_t number) {
  const StudySettings settings = design.trial(number);
  std::string row = fmt::format("{}", number);
  for (const std::string& key : design.varied()) row += "," + csv_field(text_of(settings, key, ""));
  return row;
}

fs::path write_study_report(const StudyDesign& design, const StudyFolder& study, Unreached unreached) {
  std::vector<TrialRow> rows;
  const StudyStatus status = study_status(study, &rows);
  require_none_locked(status);
  if (rows.empty()) throw InputError(study.path.string(), "has no trial that is done");
  const std::set<std::size_t> short_of = unreached_trials(rows);
  if (unreached == Unreached::dropped) {
    std::erase_if(rows, [&](const TrialRow& row) { return short_of.contains(row.trial); });
    if (rows.empty()) throw InputError(study.path.string(), "has no trial that did all of its test");
  }
  const std::string share = share_text(status.trials_done, study.record.trials);
  return write_page(study.path / "report", "report.html", [&](const fs::path& beside) {
    write_text_atomically(beside / "trials.csv", [&](std::ostream& csv) {
      csv << csv_head(design);
      for (const TrialRow& row : rows) csv << csv_row(design, row);
    });
    const fs::path figures = beside / "figures";
    Page page{design.title.empty() ? "A study" : design.title,
              {{.paragraphs = {fmt::format("{}, test {}; {} of CPU.{}", share, name_of(design.test),
                                           shown_time(status.cpu_s),
                                           unreached_words(short_of.size(), status.trials_done, unreached))},
                .tables = {options_table(design, rows)}}}};
    if (status.trials_done < study.record.trials)
      page.sections.front().notices = {"This report covers a part of the study, which is not finished yet."};
    if (!design.maps.empty()) page.sections.push_back(maps_section(design, rows, figures));
    if (design.findings)
      std::ranges::move(findings_sections(design, rows, figures), std::back_inserter(page.sections));
    return page;
  });
}

}  // namespace osteomill
