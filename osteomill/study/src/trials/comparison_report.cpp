#include "osteomill/study/comparison_report.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/csv_field.h"
#include "osteomill/base/parse_number.h"
#include "osteomill/study/paper.h"
#include "osteomill/study/run_trials.h"
#include "osteomill/study/trial_plan.h"

#include "report/report_parts.h"
#include "trials/findings_section.h"
#include "trials/hands_section.h"
#include "trials/passivity_section.h"
#include "trials/study_answers.h"
#include "trials/study_figure.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr const char* kStudyCsv = "study.csv";
constexpr const char* kOneHoleCsv = "one-hole.csv";
constexpr const char* kStabilityCsv = "stability.csv";
constexpr const char* kTitle = "6-DOF haptic algorithms compared while milling bone";
// Titles for a single algorithm and for a mix, in which nothing is compared.
constexpr const char* kTitleOfOne = "A 6-DOF haptic algorithm while milling bone";
constexpr const char* kTitleOfAMix = "Recordings of 6-DOF haptic algorithms while milling bone";

// Returns the paper's mean haptic rate in Hz, figure 6; empty if the paper does not have the algorithm or
// phase.
std::string paper_rate(const MeasuredRun& run) {
  constexpr int kRates_hz[kPapersAlgorithms.size()][kPhases.size()] = {{976, 988}, {955, 963}, {973, 989}};
  const auto* const algorithm = std::ranges::find(kPapersAlgorithms, run.algorithm.name);
  const std::size_t phase = phase_index(run.phase);
  if (algorithm == kPapersAlgorithms.end() || phase == kPhases.size()) return "";
  return fmt::format("{}", kRates_hz[algorithm - kPapersAlgorithms.begin()][phase]);
}

std::string about_stiffness(const std::vector<Recording>& recordings) {
  const auto matched = [](const Recording& recording) {
    return find_setting<double>(recording.description, kMatchedStiffnessKey);
  };
  const double* felt_N_per_mm = matched(recordings.front());
  const bool is_matched = felt_N_per_mm != nullptr &&
                          std::all_of(recordings.begin(), recordings.end(), [&](const Recording& one) {
                            return matched(one) != nullptr && *matched(one) == *felt_N_per_mm;
                          });
  if (is_matched) {
    const std::string* left_out = find_setting<std::string>(recordings.front().description, kNotMatchedKey);
    return fmt::format(
        "Stiffness is matched: each algorithm's was chosen so that a flat wall is felt as {:.3g} N/mm (the "
        "slope of the force over the depth about 0.5 N, pressed with the burr). Rotational stiffness, "
        "and the stiffness felt at an edge or with the shaft, are not matched.{}",
        *felt_N_per_mm, left_out == nullptr ? "" : " Left out of this comparison: " + *left_out + ".");
  }
  return "Stiffness is not matched: each algorithm has the stiffness of its own equations, so the hand feels "
         "a different one with each. Some of the differences in force come from this (compare "
         "--match-stiffness).";
}

std::string about_cutting(const Recording& recording) {
  const double* law = find_setting<double>(recording.description, "milling.law");
  if (law != nullptr && *law == static_cast<double>(CuttingLaw::chips)) {
    return "Bone was cut by the law of chips: a mm³ costs more energy the thinner the chips are (--law "
           "chips). The paper's experiment has a constant energy.";
  }
  return "Bone cost a constant energy for each mm³, whatever the chips, as in the paper's experiment; the "
         "window and live cut by the law of chips (--law).";
}

std::map<std::string, Probe> probes_in(const std::vector<Recording>& recordings) {
  std::map<std::string, Probe> probes;
  for (const Recording& recording : recordings) {
    const double* felt = find_setting<double>(recording.description, kFeltStiffnessKey);
    const double* error = find_setting<double>(recording.description, kTorqueErrorKey);
    if (felt != nullptr)
      probes[recording.description.algorithm.name] = {*felt, error == nullptr ? kNotMeasured : *error};
  }
  return probes;
}

constexpr const char* kWhatWasProbed =
    "Two of the columns were measured separately, on bones for which the right answer is known: the burr "
    "pressed on a flat wall, for the stiffness felt at 0.5 N, and the shaft pressed across a sharp edge, for "
    "which the torque must be lever arm times force.";

// Returns an empty text if the study does not have line-proxy.
std::string about_line_proxy(const Study& study, const MillingTool& tool) {
  for (const AlgorithmId& algorithm : study.algorithms()) {
    if (algorithm == kPapersAlgorithms.front()) {
      return fmt::format(
          "{} feels the tool's centreline alone, as the paper has it: bone is felt when it meets the burr's "
          "centre, {:.3g} mm after it met the burr's surface.",
          algorithm.label, tool.burr_radius_mm);
    }
  }
  return "";
}

// Returns a setting of three numbers; NaN if the recording does not have it.
Vec3 vector_in(const RunDescription& run, std::string_view key) {
  Vec3 vector = Vec3::Constant(kNotMeasured);
  const std::string* text = find_setting<std::string>(run, key);
  if (text == nullptr) return vector;
  const std::vector<std::string_view> numbers = csv_fields(*text);
  for (std::size_t n = 0; n < std::min<std::size_t>(3, numbers.size()); ++n)
    vector[static_cast<Eigen::Index>(n)] = parse_number<double>(numbers[n]).value_or(kNotMeasured);
  return vector;
}

// Returns the largest depth below the entry at which the burr's tip pressed on bone, mm; NaN if it never did,
// or the recording has no entry.
double depth_mm(const Recording& recording) {
  const Vec3 entry_W_mm = vector_in(recording.description, kScriptEntryKey);
  const Vec3 direction_W = vector_in(recording.description, kScriptDirectionKey);
  double deepest_mm = kNotMeasured;
  for (const TickRecord& record : recording.records)
    if (contact_of(record).burr)
      deepest_mm = std::fmax(deepest_mm, direction_W.dot(record.X_WT.position_mm - entry_W_mm));
  return deepest_mm + recording.description.tool.burr_radius_mm;
}

// Returns the depth of each algorithm's milling.
std::map<AlgorithmId, double> depths_mm(const RunGroup& group) {
  std::map<AlgorithmId, double> depths;
  for (const MeasuredRun* run : group.runs_of(std::string(kMilling)))
    if (const double depth = depth_mm(*run->recording); !std::isnan(depth)) depths[run->algorithm] = depth;
  return depths;
}

// Lists values by algorithm: "3.4 mm with 1 line-proxy and 7.6 mm with 4 barrier-shell".
std::string by_algorithm(const std::map<AlgorithmId, double>& values, const char* unit) {
  std::vector<std::string> all;
  for (const auto& [algorithm, value] : values)
    all.push_back(fmt::format("{:.2g} {} with {}", value, unit, algorithm.label));
  return in_words(all);
}

// Describes how hard the hand pushed, the largest force felt, and the actual depth of the burr.
std::string push_and_depth(const RunGroup& group) {
  const RunDescription& run = group.runs.front().recording->description;
  const double* push_N = find_setting<double>(run, "hand.push");
  if (push_N == nullptr) return "";
  using S = ScriptSettings;
  std::string text = fmt::format(
      "The hand pushes with at most {:g} N; it aims for {:g} % of that while it feeds the burr in, {:g} % "
      "while it leans the shaft and {:g} % while it holds.",
      *push_N, 100 * S::feed_push, 100 * S::lean_push, 100 * S::hold_push);
  std::map<AlgorithmId, double> greatest_N;
  for (const MeasuredRun& one : group.runs)
    if (const double force_N = one.metrics.force_N.max; !std::isnan(force_N))
      greatest_N[one.algorithm] = std::max(greatest_N[one.algorithm], force_N);
  if (!greatest_N.empty())
    text +=
        fmt::format(" The greatest force that the recorded hand felt was {}.", by_algorithm(greatest_N, "N"));
  if (const auto depths = depths_mm(group); !depths.empty())
    text += fmt::format(" The burr's tip went below the entry by {}, at most; {:g} mm were planned.",
                        by_algorithm(depths, "mm"), S::depth_mm);
  return text;
}

// Returns a warning if a burr went far deeper than the planned hole, for example by breaking through; empty
// if none did.
std::string too_deep(const RunGroup& group) {
  std::map<AlgorithmId, double> depths = depths_mm(group);
  const double planned_mm = ScriptSettings::depth_mm,
               diameter_mm = 2 * group.runs.front().recording->description.tool.burr_radius_mm;
  std::erase_if(depths, [&](const auto& one) { return one.second < planned_mm + diameter_mm; });
  if (depths.empty()) return "";
  return fmt::format(
      "In the recorded hand the burr went deeper than the {:g} mm that were planned: {}. A burr that breaks "
      "through into a hollow, or a push too heavy for it, does that; what follows is of this hole.",
      planned_mm, by_algorithm(depths, "mm"));
}

// Returns what was compared, whether it can show anything, and what it shows.
Section opening(const Study& study, const RunGroup& group, const std::vector<Recording>& recordings) {
  const std::map<std::string, Probe> probes = probes_in(recordings);
  Section section{.tables = conclusions(study, probes)};
  if (const std::string few = sample_size_warning(study); !few.empty())
    section.notices = {few + fmt::format(" For as many: --seeds {}.", study.seeds_needed())};
  if (const std::string deep = too_deep(group); !deep.empty()) section.notices.push_back(deep);
  for (const std::string& text :
       {recommendation_text(study), comparison_sentence(study, recordings.front().description.scan_name),
        study.algorithms().size() > 1 ? about_stiffness(recordings) : "", about_cutting(recordings.front()),
        about_line_proxy(study, recordings.front().description.tool), table_explanation(study),
        std::string(probes.empty() ? "" : kWhatWasProbed)})
    if (!text.empty()) section.paragraphs.push_back(text);
  return section;
}

Section opening_of_a_mix(const RunGroup& group, const char* why) {
  return {.paragraphs = {fmt::format("Recordings of {}. Nothing is concluded from them here, because {}.",
                                     labels_in_words(group.algorithms()), why)}};
}

bool belong_together(const std::vector<Recording>& recordings) {
  std::vector<const Recording*> all;
  for (const Recording& recording : recordings) all.push_back(&recording);
  return differences_table(all).rows.empty();
}

// Returns whether every algorithm has every phase that another has.
bool have_the_same_phases(const RunGroup& group) {
  return group.runs.size() == group.phases().size() * group.algorithms().size();
}

// Notice for tables next to the recordings whose study.csv does not have the same figures.
constexpr const char* kTablesMismatch =
    "The study.csv beside the recordings does not have their figures: it is from another comparison, or from "
    "another version of this program. Its other hands, grips and tremors are omitted here, and so are "
    "one-hole.csv and stability.csv.";

// Reads the tables next to the recordings if they belong to the same comparison: a folder holds only one.
ReportExtras extras_beside(const RunGroup& group) {
  const fs::path folder = group.runs.front().recording->path.parent_path();
  ReportExtras extras{.others = read_study_csv(folder / kStudyCsv, group.runs)};
  if (!has_runs(extras.others, group.runs)) return {};
  const std::uint64_t recorded = group.runs.front().seed;
  std::erase_if(extras.others,
                [&](const MeasuredRun& row) { return row.is_study_hand() && row.seed == recorded; });
  extras.passivity = read_passivity_csv(folder / kStabilityCsv, group.algorithms());
  extras.in_one_hole = read_study_csv(folder / kOneHoleCsv, group.runs);
  return extras;
}

}  // namespace

bool is_comparison(const std::vector<Recording>& recordings) {
  return std::all_of(recordings.begin(), recordings.end(), [](const Recording& recording) {
    return find_setting<std::string>(recording.description, kScriptEntryKey) != nullptr;
  });
}

fs::path write_comparison_report(const std::vector<Recording>& recordings, const fs::path& out_dir,
                                 const std::optional<ReportExtras>& measured,
                                 std::vector<Table>* result_tables, const ScanOf& scan_of) {
  const RunGroup group = group_runs(recordings, measured_phase);
  const bool belong = belong_together(recordings);
  if (!belong || !have_the_same_phases(group)) {
    return write_report(group, out_dir, scan_of, [&](const fs::path&) {
      return PageText{.title = kTitleOfAMix,
                      .opening = opening_of_a_mix(
                          group, belong ? "an algorithm lacks a phase that another was recorded with"
                                        : "they differ in more than the algorithm")};
    });
  }
  const ReportExtras extras = measured ? *measured : extras_beside(group);
  const bool has_other_tables = !measured && extras.others.empty() &&
                                fs::exists(group.runs.front().recording->path.parent_path() / kStudyCsv);
  std::vector<MeasuredRun> rows = group.runs;
  rows.insert(rows.end(), extras.others.begin(), extras.others.end());
  const Study study(std::move(rows));
  // These are not stored elsewhere, so keep them even if no figure can be drawn.
  if (!extras.others.empty() || !extras.passivity.empty() || !extras.in_one_hole.empty())
    create_folder(out_dir);
  if (!extras.others.empty()) write_study_csv(out_dir / kStudyCsv, study);
  if (!extras.passivity.empty()) write_passivity_csv(out_dir / kStabilityCsv, extras.passivity);
  if (!extras.in_one_hole.empty()) write_study_csv(out_dir / kOneHoleCsv, Study(extras.in_one_hole));
  Section came = opening(study, group, recordings);
  if (has_other_tables) came.notices.insert(came.notices.begin(), kTablesMismatch);
  if (result_tables != nullptr) *result_tables = came.tables;
  return write_report(group, out_dir, scan_of, [&](const fs::path& figures) {
    PageText text{.title = study.algorithms().size() > 1 ? kTitle : kTitleOfOne,
                  .opening = came,
                  .sections = {findings_section(study)}};
    if (study.seeds().size() > 1) text.sections.push_back(hands_section(study, draw_hands(study, figures)));
    if (!extras.in_one_hole.empty()) text.sections.push_back(one_hole_section(Study(extras.in_one_hole)));
    if (!extras.passivity.empty()) {
      text.sections.push_back(
          passivity_section(extras.passivity, draw_passivity_figure(extras.passivity, figures)));
    }
    text.further_times = {{"haptic rate in the paper, mean, on a Pentium 4 (Hz)", paper_rate}};
    if (const std::string push = push_and_depth(group); !push.empty()) text.about_the_run = {push};
    text.caption_notes = {{"rate", "The paper's figure 6 shows the rate that follows from it."},
                          {"force", "The paper's figure 7."},
                          {"torque", "The paper's figure 8."},
                          {"shaft", "The paper's figure 9."}};
    return text;
  });
}

}  // namespace osteomill
