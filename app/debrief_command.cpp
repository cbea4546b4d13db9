#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <CLI/Error.hpp>
#include <fmt/core.h>

#include "osteomill/base/file_lock.h"
#include "osteomill/base/input_error.h"
#include "osteomill/base/machine.h"
#include "osteomill/exercise/debriefing.h"
#include "osteomill/exercise/recorded_exercise.h"
#include "osteomill/study/parallel.h"

#include "app/commands.h"
#include "app/exercise_options.h"
#include "app/progress.h"

namespace osteomill::app {

namespace {

namespace fs = std::filesystem;

struct DebriefOptions {
  std::vector<std::string> named;
  std::string exercise;
  std::string out;
  bool anonymous = false;
};

// Returns the exercise's file: the one of --exercise, otherwise the recording's.
std::string exercise_of(const DebriefOptions& options, const Recording& recording) {
  const auto recorded = recorded_exercise(recording.description);
  if (!recorded && options.exercise.empty())
    throw InputError(recording.path.string(), "was made without an exercise; --exercise names one");
  return options.exercise.empty() ? recorded->file : options.exercise;
}

void warn_of_changes(const std::string& file, const Recording& recording) {
  const auto recorded = recorded_exercise(recording.description);
  if (recorded && text_fingerprint(file) != recorded->fingerprint) {
    warn(fmt::format("{}: differs from the exercise recorded in {} ({})", file, recording.path.string(),
                     recorded->title));
  }
}

// Returns the named recordings and those in the named folders.
std::vector<fs::path> recordings_in(const std::vector<std::string>& named) {
  std::vector<fs::path> paths;
  for (const fs::path path : named) {
    if (!fs::is_directory(path)) {
      paths.push_back(path);
      continue;
    }
    const std::size_t before = paths.size();
    for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
      // Skips unfinished files, which are being written or left by a program that ended.
      const std::string name = entry.path().filename().string();
      if (name.ends_with(".h5") && !name.ends_with(".part.h5") && !name.starts_with("."))
        paths.push_back(entry.path());
    }
    if (paths.size() == before) throw InputError(path.string(), "holds no recordings (.h5)");
    std::sort(paths.begin() + static_cast<std::ptrdiff_t>(before), paths.end());
  }
  // Removes duplicates.
  std::set<fs::path> seen;
  std::erase_if(paths, [&](const fs::path& path) { return !seen.insert(fs::weakly_canonical(path)).second; });
  return paths;
}

std::string row_text(const MeasuredValue& row) {
  std::string text = row.measure + ": ";
  text += row.value ? fmt::format("{:.4g}", *row.value) : "not measured";
  if (row.value && !row.unit.empty()) text += " " + row.unit;
  if (row.is_met) text += fmt::format(", {} ({})", row.limit, *row.is_met ? "met" : "not met");
  return text;
}

void anonymise(DebriefedAttempt& attempt, const std::string& name) {
  attempt.recording.clear();
  attempt.trainee = name;
}

// Writes the page of one attempt, compared with the earlier ones of the same person.
void write_attempt(const DebriefOptions& options, const LoadedExercise& loaded, const Recording& recording,
                   std::vector<DebriefedAttempt> before) {
  const Attempt attempt = make_attempt(loaded.placed, loaded.bone.volume, recording);
  DebriefedAttempt own = debriefed(attempt, recording);
  DebriefPeers peers = load_peers(attempt, recording);
  peers.before = std::move(before);
  if (options.anonymous) {
    anonymise(own, "");
    if (peers.first) anonymise(peers.first->measured, "");
    if (!peers.original_missing_reason.empty())
      peers.original_missing_reason = "it cannot be read or measured.";
  }
  write_debriefing(options.out, attempt, recording, own, peers);
  fmt::print("{}\n", loaded.placed.exercise.title);
  if (const auto from = branch_point(recording.description))
    fmt::print("continues {} at {:.3f} s, after {} ticks\n",
               options.anonymous ? "another recording" : from->recording, from->time_s, from->ticks);
  if (!peers.original_missing_reason.empty())
    warn("without the recording that it continues: " + peers.original_missing_reason);
  for (const MeasuredValue& row : own.rows)
    if (!row.limit.empty()) fmt::print("{}\n", row_text(row));
}

void debrief_one(const DebriefOptions& options) {
  const Recording recording = read_recording_chain(options.named.front());
  const std::string file = exercise_of(options, recording);
  warn_of_changes(file, recording);
  write_attempt(options, load_exercise(file, {}, &recording), recording, {});
}

// Cache of the recordings' exercises. Thread-safe.
class Exercises {
 public:
  std::shared_ptr<const LoadedExercise> of(const DebriefOptions& options, const Recording& recording) {
    const std::string file = exercise_of(options, recording);
    const auto recorded = recorded_exercise(recording.description);
    const std::lock_guard lock(mutex_);
    auto& loaded = loaded_[options.exercise.empty() ? recorded->fingerprint : ""];
    if (!loaded) {
      loaded = std::make_shared<const LoadedExercise>(load_exercise(file, {}, &recording));
      warn_of_changes(file, recording);
    }
    return loaded;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<const LoadedExercise>> loaded_;
};

// An attempt, or the reason why it could not be read.
struct ReadAttempt {
  std::shared_ptr<const LoadedExercise> exercise;
  DebriefedAttempt attempt;
  std::string fault;
  /// The recording that this one continues, which then is not an attempt of its own.
  fs::path continues;
};

ReadAttempt read_attempt(const DebriefOptions& options, Exercises& exercises, const fs::path& path) {
  try {
    const Recording recording = read_recording_chain(path);
    const auto loaded = exercises.of(options, recording);
    return {loaded, debriefed(make_attempt(loaded->placed, loaded->bone.volume, recording), recording), "",
            recording.continues};
  } catch (const InputError& error) {
    return {nullptr, {}, error.what(), {}};
  }
}

std::vector<ReadAttempt> read_attempts(const DebriefOptions& options, const std::vector<fs::path>& paths) {
  Exercises exercises;
  std::vector<ReadAttempt> read(paths.size());
  run_in_parallel(
      paths.size(), allowed_threads(),
      [&](std::size_t n) { read[n] = read_attempt(options, exercises, paths[n]); },
      [&](std::size_t done) {
        show_progress("measuring", static_cast<double>(done) / static_cast<double>(paths.size()));
      });
  end_progress();
  return read;
}

// Returns the most frequent exercise; null if there are no attempts.
std::shared_ptr<const LoadedExercise> common_exercise(const std::vector<ReadAttempt>& read) {
  std::shared_ptr<const LoadedExercise> common;
  std::ptrdiff_t most = 0;
  for (const ReadAttempt& one : read) {
    const auto count = std::ranges::count(read, one.exercise, &ReadAttempt::exercise);
    if (one.exercise && count > most) std::tie(common, most) = std::pair(one.exercise, count);
  }
  return common;
}

// The attempts of one exercise, by time, and the faults of the other recordings.
struct Attempts {
  std::shared_ptr<const LoadedExercise> exercise;
  std::vector<DebriefedAttempt> attempts;
  std::vector<std::string> faults;
};
Attempts attempts_of(std::vector<ReadAttempt> read, const std::vector<fs::path>& paths) {
  Attempts all{common_exercise(read), {}, {}};
  std::set<fs::path> continued;
  for (const ReadAttempt& one : read) continued.insert(fs::weakly_canonical(one.continues));
  for (std::size_t n = 0; n < read.size(); ++n) {
    if (!read[n].exercise) {
      all.faults.push_back(std::move(read[n].fault));
    } else if (read[n].exercise != all.exercise) {
      all.faults.push_back(fmt::format("{}: belongs to another exercise ({})", paths[n].string(),
                                       read[n].exercise->placed.exercise.title));
    } else if (!continued.contains(fs::weakly_canonical(paths[n]))) {
      all.attempts.push_back(std::move(read[n].attempt));
    }
  }
  std::ranges::stable_sort(all.attempts, {}, &DebriefedAttempt::date_utc);
  return all;
}

// Replaces names by numbers in the order of the attempts.
void pseudonymise(std::vector<DebriefedAttempt>& attempts) {
  std::map<std::string, std::string> names;
  for (DebriefedAttempt& attempt : attempts) {
    std::string& name = names[attempt.trainee];
    if (name.empty() && !attempt.trainee.empty()) name = fmt::format("person {}", names.size());
    anonymise(attempt, name);
  }
}

void debrief_many(const DebriefOptions& options) {
  const std::vector<fs::path> paths = recordings_in(options.named);
  auto [exercise, attempts, faults] = attempts_of(read_attempts(options, paths), paths);
  for (const std::string& fault : faults) print_error("osteomill: " + in_one_line(fault) + "\n");
  if (attempts.empty()) throw CLI::RuntimeError(1);
  std::set<std::string> names;
  for (const DebriefedAttempt& attempt : attempts) names.insert(attempt.trainee);
  const std::string last = attempts.back().recording;
  if (options.anonymous) pseudonymise(attempts);
  if (names.size() == 1) {
    attempts.pop_back();
    write_attempt(options, *exercise, read_recording_chain(last), std::move(attempts));
  } else {
    std::vector<std::string> unread = faults;
    if (options.anonymous && !faults.empty())
      unread = {fmt::format("{} that could not be measured", faults.size())};
    write_class_debriefing(options.out, exercise->placed.exercise, attempts, unread);
  }
  if (faults.empty()) return;
  fmt::print("{}\n", (fs::path(options.out) / "debrief.html").string());
  throw CLI::RuntimeError(1);
}

void run_debrief(const DebriefOptions& options) {
  const OutputFolder held(options.out);
  if (options.named.size() == 1 && !fs::is_directory(options.named.front())) {
    debrief_one(options);
  } else {
    debrief_many(options);
  }
  fmt::print("{}\n", (fs::path(options.out) / "debrief.html").string());
}

}  // namespace

void add_debrief_command(CLI::App& program) {
  auto options = std::make_shared<DebriefOptions>();
  CLI::App* command = program.add_subcommand(
      "debrief", "Measure recorded sessions against their exercise, and write a page and a CSV table");
  command->group("Exercises");
  command
      ->add_option("recordings", options->named,
                   "Recordings (.h5), or folders of them; those of several trainees make a class page")
      ->required();
  command
      ->add_option("--exercise", options->exercise,
                   "Exercise to measure against (default: the recording's own)")
      ->type_name("FILE");
  command->add_flag("--anonymous", options->anonymous, "Leave out the names of people and files");
  command->add_option("--out", options->out, "Folder for debrief.html, debrief.csv and progress.csv")
      ->required()
      ->type_name("FOLDER");
  add_quiet_option(*command);
  command->callback([=] { run_debrief(*options); });
}

}  // namespace osteomill::app
