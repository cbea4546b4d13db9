#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/Error.hpp>
#include <CLI/Option.hpp>
#include <fmt/format.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/file_lock.h"
#include "osteomill/base/machine.h"
#include "osteomill/base/parse_number.h"
#include "osteomill/recording/recording.h"
#include "osteomill/study/comparison_report.h"
#include "osteomill/study/match_stiffness.h"
#include "osteomill/study/measure_passivity.h"
#include "osteomill/study/paper.h"
#include "osteomill/study/probe_bones.h"
#include "osteomill/study/run_groups.h"
#include "osteomill/study/run_trials.h"
#include "osteomill/study/study.h"
#include "osteomill/study/trial_plan.h"
#include "osteomill/volume/density_grid.h"

#include "app/commands.h"
#include "app/config_file.h"
#include "app/option_checks.h"
#include "app/progress.h"
#include "app/scan_options.h"
#include "app/trial_options.h"

namespace osteomill::app {

namespace fs = std::filesystem;

namespace {

// The exact test of 200 pairs takes 10 ms; the trials would take too long.
constexpr int kMaxSeeds = 200;

struct CompareOptions {
  ScanOptions scan;
  TrialOptions trial;
  std::vector<AlgorithmDescription> algorithms = all_algorithms();
  int seeds = 1;
  int threads = static_cast<int>(allowed_threads());
  bool no_stability = false;
  bool match_stiffness = false;
  /// Felt stiffness to match on a flat wall, N/mm; 0 for that of the softest algorithm.
  double matched_N_per_mm = 0;
  std::string out = "osteomill-comparison";
};

// Returns one trial per algorithm, with the first seed.
std::vector<TrialPlan> trials_of(const CompareOptions& options, const LoadedBone& bone,
                                 const std::string& command_line) {
  TrialPlan plan = trial_plan(bone, options.trial, command_line);
  plan.comparison = new_comparison();
  plan.scan_settings = scan_settings(options.scan);
  plan.settings.hand_and_device.script.until_leant = true;
  std::vector<TrialPlan> trials;
  for (const AlgorithmDescription& algorithm : options.algorithms) {
    trials.push_back(options.seeds > 1 ? with_seed(plan, options.trial.seed) : plan);
    trials.back().settings.algorithm = algorithm;
    warn_of_settings(trials.back().settings, bone.volume.geometry());
  }
  return trials;
}

// Ignores algorithms that cannot carry 0.5 N.
double softest_felt_N_per_mm(const std::vector<TrialPlan>& trials, const Volume& wall) {
  double softest = std::numeric_limits<double>::infinity();
  for (const TrialPlan& trial : trials) {
    const double felt = felt_stiffness_N_per_mm(trial.settings, wall);
    if (felt > 0) softest = std::min(softest, felt);
  }
  if (std::isinf(softest)) throw std::invalid_argument("no algorithm can carry 0.5 N on a flat wall");
  return softest;
}

// Removes the algorithms that cannot be matched, because a comparison with them would only show their
// stiffness. Throws std::invalid_argument if none is left, or only one of several.
void match_stiffness(const CompareOptions& options, std::vector<TrialPlan>& trials) {
  const Volume wall = flat_wall(trials.front().settings.tool);
  const double felt_N_per_mm =
      options.matched_N_per_mm > 0 ? options.matched_N_per_mm : softest_felt_N_per_mm(trials, wall);
  std::vector<TrialPlan> matched;
  std::vector<std::string> left_out;
  for (TrialPlan& trial : trials) {
    try {
      trial.settings.haptics.named.push_back(match_felt_stiffness(felt_N_per_mm, trial.settings, wall));
      trial.matched_N_per_mm = felt_N_per_mm;
      matched.push_back(trial);
    } catch (const std::invalid_argument& error) {
      left_out.emplace_back(error.what());
    }
  }
  const std::string reasons = fmt::format("{}", fmt::join(left_out, "; "));
  if (matched.size() < std::min<std::size_t>(2, trials.size())) throw std::invalid_argument(reasons);
  if (!left_out.empty()) warn("left out: " + reasons);
  for (TrialPlan& trial : matched) trial.not_matched = reasons;
  trials = std::move(matched);
}

// Adds trials of other grips, which every hand also tries with the paper's algorithm 2.
void add_other_grips(std::vector<TrialPlan>& others, const TrialPlan& trial) {
  if (trial.settings.algorithm.id != kPapersAlgorithms[1]) return;
  for (const TrialPlan& grip : trials_in_other_grips(trial)) others.push_back(grip);
}

// Returns the trials that are not recorded.
std::vector<TrialPlan> other_hands(const CompareOptions& options, const std::vector<TrialPlan>& trials) {
  std::vector<TrialPlan> others;
  for (const TrialPlan& trial : trials) {
    add_other_grips(others, trial);
    for (const TrialPlan& tremor : trials_with_other_tremors(trial)) others.push_back(tremor);
  }
  for (int n = 1; n < options.seeds; ++n) {
    for (const TrialPlan& trial : trials) {
      const TrialPlan other = with_seed(trial, options.trial.seed + static_cast<std::uint64_t>(n));
      others.push_back(other);
      add_other_grips(others, other);
    }
  }
  return others;
}

// Returns events that map progress 0..1 to the range from `from` to `to`.
RunEvents events_of_a_part(double from, double to) {
  RunEvents events = events_on_terminal();
  events.progress = [=](std::string_view what, double fraction) {
    show_progress(what, from + (to - from) * fraction);
  };
  return events;
}

// Runs the test for every seed; the first hand is the comparison's own.
std::vector<MeasuredRun> hold_in_one_hole(const CompareOptions& options, const std::vector<TrialPlan>& trials,
                                          const RunEvents& events) {
  const auto own = std::ranges::find(trials, default_algorithm().id,
                                     [](const TrialPlan& trial) { return trial.settings.algorithm.id; });
  TrialPlan miller = own == trials.end() ? trials.front() : *own;
  miller.settings.algorithm = default_algorithm();
  std::vector<TrialPlan> hands{miller};
  hands.reserve(static_cast<std::size_t>(options.seeds));
  for (int n = 1; n < options.seeds; ++n)
    hands.push_back(with_seed(miller, options.trial.seed + static_cast<std::uint64_t>(n)));
  std::vector<MeasuredRun> runs;
  for (const std::vector<MeasuredRun>& of_hand :
       run_trials(hands, "one hole", static_cast<std::size_t>(options.threads), events,
                  [&](const TrialPlan& hand) { return osteomill::hold_in_one_hole(hand, trials); }))
    runs.insert(runs.end(), of_hand.begin(), of_hand.end());
  return runs;
}

void probe_algorithms(std::vector<TrialPlan>& trials) {
  const MillingTool& tool = trials.front().settings.tool;
  const Volume wall = flat_wall(tool), edge = sharp_edge(tool);
  for (TrialPlan& trial : trials) trial.probed = probe(trial.settings, wall, edge);
}

std::vector<PassivityRow> press_on_walls(const CompareOptions& options, const std::vector<TrialPlan>& trials,
                                         const RunEvents& events) {
  const TrialSettings& settings = trials.front().settings;
  const Volume wall = flat_wall(settings.tool);
  std::vector<AlgorithmDescription> algorithms;
  for (const TrialPlan& trial : trials) algorithms.push_back(trial.settings.algorithm);
  std::vector<PassivityRow> rows = run_trials(
      passivity_cases(algorithms, settings), "stability", static_cast<std::size_t>(options.threads), events,
      [&](const TrialSettings& device) { return measure_passivity(device, wall); });
  end_progress();
  return rows;
}

void run_compare(const CompareOptions& options, const std::string& command_line) {
  const OutputFolder folder(options.out);
  const LoadedBone bone = load_bone(options.scan);
  std::vector<TrialPlan> trials = trials_of(options, bone, command_line);
  if (options.match_stiffness) match_stiffness(options, trials);
  probe_algorithms(trials);
  const EntryPictures pictures(bone.volume, trials.front().densities.reference, trials.front().entry,
                               events_on_terminal(), !options.scan.scan.empty());
  std::vector<fs::path> paths;
  ReportExtras extras;
  // For progress: the walls take about as long as the first hand's trials.
  const std::vector<TrialPlan> others = other_hands(options, trials);
  const double threads = options.threads;
  const double recorded = static_cast<double>(trials.size()), walls = options.no_stability ? 0 : recorded;
  const double holes = trials.size() > 1 ? options.seeds : 0;
  const double whole = recorded + (static_cast<double>(others.size()) + holes + walls) / threads;
  const double until_walls = 1 - walls / threads / whole, until_holes = until_walls - holes / threads / whole;
  // Files of an earlier comparison are removed only when this one is complete.
  write_folder_atomically(
      options.out,
      [&](const fs::path& beside) {
        for (std::size_t n = 0; n < trials.size(); ++n) {
          const double begun = static_cast<double>(n);
          for (const fs::path& path : record_trial(trials[n], pictures, beside,
                                                   events_of_a_part(begun / whole, (begun + 1) / whole)))
            paths.push_back(options.out / path.filename());
        }
        extras.others = run_study_trials(others, static_cast<std::size_t>(options.threads),
                                         events_of_a_part(recorded / whole, until_holes));
        if (trials.size() > 1)
          extras.in_one_hole = hold_in_one_hole(options, trials, events_of_a_part(until_holes, until_walls));
        if (!options.no_stability) {
          extras.passivity = press_on_walls(options, trials, events_of_a_part(until_walls, 1));
        }
      },
      is_comparison_output);
  std::vector<Recording> recordings;
  for (const fs::path& path : paths) recordings.push_back(read_recording(path));
  std::vector<MeasuredRun> rows = group_runs(recordings, measured_phase).runs;
  rows.insert(rows.end(), extras.others.begin(), extras.others.end());
  for (const std::string& line : unreached_lines(Study(std::move(rows)))) warn(line);
  std::vector<Table> result_tables;
  const fs::path page =
      write_comparison_report(recordings, options.out, extras, &result_tables, [&](const Recording&) {
        return std::shared_ptr<const Volume>(std::shared_ptr<const Volume>(), &bone.volume);
      });
  print_tables(result_tables);
  fmt::print("{}\n", page.string());
}

// Several seeds draw their hands at random, so the hand's settings cannot be given as well.
void refuse_a_hand(const CLI::App& command) {
  for (const char* option :
       {"--hand-stiffness", "--hand-damping", "--hand-torsional-stiffness", "--hand-torsional-damping"}) {
    if (command.count(option) > 0) {
      throw CLI::ValidationError(option, "cannot be given with --seeds above 1, which draws hands itself");
    }
  }
}

void refuse_a_stiffness(const CLI::App& command) {
  if (command.count("--stiffness") > 0) {
    throw CLI::ValidationError("--stiffness", "cannot be given with --match-stiffness, which chooses it");
  }
}

void add_match_stiffness(CLI::App& command, CompareOptions& options) {
  const auto take = [&options](const std::string& text) {
    options.match_stiffness = true;
    options.matched_N_per_mm = parse_finite(text).value_or(0);
  };
  const auto check = [](const std::string& text) {
    const bool usable = text.empty() || text == "softest" || positive_number()(std::string(text)).empty();
    return usable ? std::string() : text + " is neither a positive number nor softest";
  };
  command
      .add_option_function<std::string>(
          "--match-stiffness", take,
          "Match the algorithms' stiffness so that a flat wall feels this stiff, or as stiff as with the "
          "softest algorithm; algorithms that cannot be matched are left out (docs/algorithms.md)")
      ->expected(0, 1)
      ->check(check)
      ->type_name("N/mm|softest");
}

}  // namespace

void add_compare_command(CLI::App& program, const std::string& command_line) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command = program.add_subcommand(
      "compare",
      "Mill with each algorithm in a simulated hand (section 8.2 of the paper) and write a report");
  command->group("Compare and measure");
  add_scan_options(*command, options->scan);
  command->option_defaults()->group("The comparison");
  command->add_option("--out", options->out, "Folder for the report and the recordings")
      ->type_name("FOLDER")
      ->capture_default_str();
  add_algorithm_option(*command, options->algorithms);
  add_count(*command, "--seeds", options->seeds, kMaxSeeds,
            "Number of simulated hands, each with its own seed, counted up from --seed; with more than one, "
            "the report states which differences are significant");
  command->add_flag("--no-stability", options->no_stability,
                    "Skip the measurement of the highest passive stiffness against a flat wall");
  add_count(*command, "--threads", options->threads, kMaxThreads,
            "Number of trials to run in parallel; recorded trials run one at a time (default: the number of "
            "processors that taskset and cgroup v2 allow)");
  add_match_stiffness(*command, *options);
  add_trial_options(*command, options->trial);
  command->get_option("--seed")->description(
      "Seed of the simulated hand's tremor, and the first of the seeds of --seeds");
  add_quiet_option(*command);
  command->callback([=] {
    apply_config_file(*command);
    apply_implied_law(*command, options->trial.milling.setup);
    if (options->seeds > 1) refuse_a_hand(*command);
    if (options->match_stiffness) refuse_a_stiffness(*command);
    run_compare(*options, command_line);
  });
}

}  // namespace osteomill::app
