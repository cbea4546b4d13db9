#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/Error.hpp>
#include <CLI/Option.hpp>
#include <fmt/format.h>
#include <malloc.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/file_lock.h"
#include "osteomill/base/input_error.h"
#include "osteomill/base/machine.h"
#include "osteomill/study/page.h"
#include "osteomill/study/study_report.h"
#include "osteomill/study/study_slices.h"

#include "app/commands.h"
#include "app/option_checks.h"
#include "app/progress.h"
#include "app/slurm.h"
#include "app/study_trials.h"

namespace osteomill::app {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMaxSlices = 1'000'000;
// A scheduler needs a second or two per task, and a lost slice runs again as a whole.
constexpr double kSlice_s = 60;

struct StudyOptions {
  std::string study;
  std::string out;
  std::string on;
  std::size_t slices = 0;
  std::optional<std::size_t> slice;
  int threads = static_cast<int>(allowed_threads());
  bool list = false, estimate = false, status = false, resume = false, report = false, drop_unreached = false;
};

struct StudyInFolder {
  explicit StudyInFolder(const fs::path& path)
      : folder{path, record_in(path)}, trials((path / "study.toml").string(), folder.record.scans_from) {
    folder.test = trials.design().test;
    if (folder.record.trials != trials.design().trial_count())
      throw InputError((path / "study.h5").string(), "belongs to a study with another number of trials");
    trials.expect(folder.record.bones);
    if (hash_of_file(path / "study.toml") != folder.record.study_hash)
      throw InputError((path / "study.toml").string(), "has changed since the study was begun");
  }
  static StudyRecord record_in(const fs::path& path) {
    if (auto record = read_study_record(path)) return *std::move(record);
    throw InputError(path.string(), "is not the folder of a study: it has no study.h5");
  }

  StudyFolder folder;
  StudyTrials trials;
};

std::uint64_t program_hash() {
  return hash_of_file("/proc/self/exe");
}

void require_same_program(const StudyFolder& folder) {
  if (folder.record.program_hash != program_hash())
    throw InputError(folder.path.string(), "was begun with another build of this program");
}

// Checks every trial, so that a fault is reported before the first trial runs.
void check_every_trial(StudyTrials& study) {
  constexpr std::size_t kBetweenProgress = 256;
  const std::size_t count = study.design().trial_count();
  for (std::size_t n = 0; n < count; ++n) {
    study.make(n, 1);
    if (n % kBetweenProgress == 0)
      show_progress("checking", static_cast<double>(n) / static_cast<double>(count));
  }
  end_progress();
  if (const std::string warning = study.settings_warning(); !warning.empty()) warn(warning);
}

// Returns the CPU times of three trials spread over the study, in ascending order.
std::vector<double> time_three_trials(StudyTrials& study) {
  const std::size_t count = study.design().trial_count();
  std::vector<double> taken_s;
  for (const std::size_t sixth : {1u, 3u, 5u}) {
    const std::size_t number = count * sixth / 6;
    const std::vector<TrialPlan> trial = study.make(number, 1);
    try {
      taken_s.push_back(run_single_trial(study.design().test, trial.front()).cpu_s);
    } catch (...) {
      rethrow_with_trial(study.file(), number);
    }
  }
  std::sort(taken_s.begin(), taken_s.end());
  return taken_s;
}

void estimate(StudyTrials& study, int threads) {
  const std::vector<double> taken_s = time_three_trials(study);
  const auto all = [&](double trial_s) {
    return trial_s * static_cast<double>(study.design().trial_count());
  };
  fmt::print(
      "{} trials; three of them took {:.3g}, {:.3g} and {:.3g} s of CPU\n"
      "{} of CPU in total by the median ({} to {} by the others), {} on {} threads\n",
      study.design().trial_count(), taken_s[0], taken_s[1], taken_s[2], shown_time(all(taken_s[1])),
      shown_time(all(taken_s[0])), shown_time(all(taken_s[2])), shown_time(all(taken_s[1]) / threads),
      threads);
}

void list(const StudyDesign& design) {
  fmt::print("{}\n", list_head(design));
  for (std::size_t n = 0; n < design.trial_count(); ++n) fmt::print("{}\n", list_row(design, n));
}

void status(const StudyFolder& folder) {
  const StudyRecord& record = folder.record;
  const StudyStatus now = study_status(folder);
  fmt::print("{} of {} trials are done ({:.3g} %), {} of {} slices\n", now.trials_done, record.trials,
             100 * static_cast<double>(now.trials_done) / static_cast<double>(record.trials), now.done.size(),
             record.slices());
  for (const fs::path& file : now.damaged)
    fmt::print("{} cannot be used: truncated, damaged, or from another study\n", file.string());
  for (const fs::path& file : now.locked)
    fmt::print("{} is locked by another program, and cannot be read now\n", file.string());
  if (now.missing.empty()) return;
  fmt::print("left: slices {}", ranges_text(now.missing));
  if (now.trials_done > 0) {
    const double trial_s = now.cpu_s / static_cast<double>(now.trials_done);
    fmt::print(", {} of CPU, estimated from the others",
               shown_time(trial_s * static_cast<double>(record.trials - now.trials_done)));
  }
  fmt::print("\n");
}

void run_slice(StudyInFolder& study, std::size_t number, int threads, const RunEvents& events) {
  const StudyFolder& folder = study.folder;
  const std::vector<TrialPlan> trials =
      study.trials.make(folder.record.first_of(number), folder.record.size_of(number));
  write_slice(folder,
              osteomill::run_slice(folder, number, trials, static_cast<std::size_t>(threads), events));
}

void run_here(StudyInFolder& study, const std::vector<std::size_t>& slices, int threads) {
  RunEvents events = events_on_terminal();
  for (std::size_t n = 0; n < slices.size(); ++n) {
    events.progress = [&](std::string_view what, double fraction) {
      show_progress(what, (static_cast<double>(n) + fraction) / static_cast<double>(slices.size()));
    };
    run_slice(study, slices[n], threads, events);
  }
  end_progress();
}

void run_missing_slices(StudyInFolder& study, const StudyOptions& options, std::size_t array_limit) {
  const StudyStatus now = study_status(study.folder);
  require_none_locked(now);
  const std::vector<std::size_t>& missing = now.missing;
  if (!options.on.empty()) {
    submit_to_slurm(study.folder.path, missing, array_limit);
  } else {
    run_here(study, missing, options.threads);
  }
  fmt::print("{}\n", study.folder.path.string());
}

void create_study_folder(const StudyOptions& options) {
  const fs::path file = options.study, out = options.out;
  StudyTrials study(options.study, fs::absolute(file).parent_path());
  StudyRecord record{.study_hash = hash_of_file(file),
                     .program_hash = program_hash(),
                     .scans_from = fs::absolute(file).parent_path().string(),
                     .trials = study.design().trial_count()};
  if (const auto there = read_study_record(out)) {
    throw InputError(options.out, there->study_hash == record.study_hash
                                      ? "already holds this study; osteomill study " + options.out +
                                            " --resume continues it"
                                      : "holds another study");
  }
  if (fs::exists(out / "study.toml") && hash_of_file(out / "study.toml") != record.study_hash)
    throw InputError((out / "study.toml").string(), "already exists and would be overwritten");
  check_every_trial(study);
  const std::size_t wanted =
      options.slices > 0 ? (record.trials + options.slices - 1) / options.slices
                         : static_cast<std::size_t>(kSlice_s / std::max(1e-3, time_three_trials(study)[1]));
  record.trials_a_slice = std::clamp<std::size_t>(wanted, 1, record.trials);
  record.bones.assign(study.fingerprints().begin(), study.fingerprints().end());
  write_file_atomically(out / "study.toml", [&](const fs::path& beside) {
    std::error_code error;
    fs::copy_file(file, beside, fs::copy_options::overwrite_existing, error);
    if (error) throw InputError((out / "study.toml").string(), "cannot be written: " + error.message());
  });
  write_study_record(out, record);
}

void begin(const StudyOptions& options) {
  if (!options.on.empty()) require_submittable(options.out);
  const std::size_t array_limit = options.on.empty() ? 0 : slurm_array_limit();
  const OutputFolder folder(options.out);
  create_study_folder(options);
  StudyInFolder study(options.out);
  run_missing_slices(study, options, array_limit);
}

void continue_study(StudyInFolder& study, const StudyOptions& options) {
  const StudyFolder& folder = study.folder;
  if (options.status) return status(folder);
  if (options.report) {
    const OutputFolder held(folder.path / "report");
    fmt::print("{}\n", write_study_report(study.trials.design(), folder,
                                          options.drop_unreached ? Unreached::dropped : Unreached::marked)
                           .string());
    return;
  }
  require_same_program(folder);
  if (options.slice) {
    if (*options.slice >= folder.record.slices())
      throw InputError(folder.path.string(),
                       fmt::format("has slices 0 to {}, not {}", folder.record.slices() - 1, *options.slice));
    // Another task may have run it while this one waited in the queue.
    if (!read_slice(folder, *options.slice))
      run_slice(study, *options.slice, options.threads, events_on_terminal());
    return;
  }
  const OutputFolder held(folder.path);
  const std::size_t array_limit = options.on.empty() ? 0 : slurm_array_limit();
  check_every_trial(study.trials);
  run_missing_slices(study, options, array_limit);
}

void run_study(const StudyOptions& options) {
  // Returns a trial's large blocks to the system when it ends. Otherwise glibc raises the threshold and keeps
  // them in its heap, which small leftovers of each trial fragment (6 GB after 300 trials on a wall).
  ::mallopt(M_MMAP_THRESHOLD, 1 << 20);
  if (options.drop_unreached && !options.report)
    throw CLI::ValidationError("--drop-unreached", "needs --report");
  if (fs::is_directory(options.study)) {
    if (!options.status && !options.report && !options.resume && !options.slice)
      throw CLI::ValidationError("study", "is a folder, which needs --status, --resume, --report or --slice");
    StudyInFolder study(options.study);
    return continue_study(study, options);
  }
  if (options.list || options.estimate) {
    StudyTrials study(options.study, fs::absolute(options.study).parent_path());
    check_every_trial(study);
    return options.list ? list(study.design()) : estimate(study, options.threads);
  }
  if (options.status || options.report || options.resume || options.slice)
    throw InputError(options.study, "is not the folder of a study");
  if (options.out.empty()) throw CLI::ValidationError("--out", "is required to begin a study");
  begin(options);
}

}  // namespace

void add_study_command(CLI::App& program) {
  auto options = std::make_shared<StudyOptions>();
  CLI::App* command = program.add_subcommand(
      "study", "Run many trials over a grid, a list or a Latin hypercube of any trial settings");
  command->group("Compare and measure");
  command->option_defaults()->group("The study");
  command
      ->add_option("study", options->study,
                   "Study file (TOML, docs/studies.md), or the folder of a study already begun")
      ->required()
      ->check(not_empty())
      ->type_name("FILE|FOLDER");
  command->add_option("--out", options->out, "Folder for a new study")
      ->check(not_empty())
      ->type_name("FOLDER");
  command->add_flag("--list", options->list, "Print all trials without running them");
  command->add_flag("--estimate", options->estimate,
                    "Estimate the computing time of the study from three trials");
  command->add_flag("--status", options->status,
                    "Print which trials of a study folder are done and which are left");
  command->add_flag("--resume", options->resume, "Run only the missing trials of a study folder");
  command->add_flag("--report", options->report,
                    "Write a table and maps of the finished trials of a study folder");
  command->add_flag("--drop-unreached", options->drop_unreached,
                    "With --report, leave out trials that did not complete their test; otherwise they count "
                    "and are hatched in the maps");
  command->option_defaults()->group("Running it");
  command
      ->add_option("--on", options->on,
                   "Submit the study to this scheduler of a cluster (default: run it here)")
      ->check(one_of("scheduler", {"slurm"}))
      ->type_name("slurm");
  command
      ->add_option("--slices", options->slices,
                   "Number of slices, each a file of trials (default: about one minute of computing per "
                   "slice, estimated from three trials)")
      ->check(whole_number(1, kMaxSlices))
      ->type_name("COUNT");
  command
      ->add_option("--slice", options->slice, "Run only this slice of a study folder, as a cluster task does")
      ->check(whole_number(0, kMaxSlices))
      ->type_name("NUMBER");
  add_count(*command, "--threads", options->threads, kMaxThreads,
            "Number of trials to run in parallel (default: the number of processors that taskset and cgroup "
            "v2 allow)");
  command->option_defaults()->group("Options");
  add_quiet_option(*command);
  command->callback([=] { run_study(*options); });
}

}  // namespace osteomill::app
