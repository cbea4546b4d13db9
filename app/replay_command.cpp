#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/Error.hpp>
#include <fmt/core.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/input_error.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/recording/record_columns.h"
#include "osteomill/recording/recorder.h"
#include "osteomill/recording/recording.h"
#include "osteomill/recording/replay_recording.h"
#include "osteomill/recording/run_description.h"
#include "osteomill/session/milling_session.h"
#include "osteomill/session/milling_setup.h"
#include "osteomill/session/tick_counts.h"
#include "osteomill/session/trajectory.h"
#include "osteomill/volume/bone_densities.h"

#include "app/branch_options.h"
#include "app/commands.h"
#include "app/config_file.h"
#include "app/exercise_file.h"
#include "app/exercise_options.h"
#include "app/milling_options.h"
#include "app/progress.h"
#include "app/scan_options.h"
#include "app/trial_options.h"

namespace osteomill::app {

namespace {

struct ReplayOptions {
  std::string input;
  ScanOptions scan;
  ExerciseOptions exercise;
  BranchOptions from;
  MillingOptions milling;
  std::string out;
  std::string record;
  bool verify = false;
  // The command that owns these options.
  const CLI::App* command = nullptr;

  bool is_given(const std::string& option) const { return command->count(option) > 0; }
};

// Stores the replay's ticks for the log, warns of no-go contacts, and counts faults and labels.
class Log {
 public:
  Log(const ReplayOptions& options, std::size_t ticks, const Volume& bone)
      : options_(options), ticks_(ticks), labels_(bone.labels()) {
    // Checks the output path before the replay.
    if (!options.out.empty()) output_path(options.out);
    log_.reserve(ticks);
  }

  void add(const TickRecord& record) {
    log_.push_back(record);
    faults_.add(record);
    if (const auto touched = labels_.add(record)) warn_despite_quiet(*touched);
    if (log_.size() % 1000 == 0)
      show_progress("replay", static_cast<double>(log_.size()) / static_cast<double>(ticks_));
  }

  void write() const {
    end_progress();
    if (const auto text = faults_.sentence())
      warn((options_.input.empty() ? options_.from.recording : options_.input) + ": " + *text);
    if (!options_.out.empty()) write_csv(options_.out, log_);
    for (const std::string& line : label_lines(labels_)) fmt::print("label {}\n", line);
    if (!options_.out.empty()) fmt::print("{}\n", options_.out);
  }

 private:
  const ReplayOptions& options_;
  std::size_t ticks_;
  FaultCount faults_;
  LabelCount labels_;
  std::vector<TickRecord> log_;
};

void begin_recorder(std::optional<Recorder>& recorder, const std::string& path, const RunDescription& run,
                    Recorder::FirstSession begins) {
  recorder.emplace(path, run, begins, Recorder::UnfinishedFile::remove);
  if (const std::string kept = recorder->leftover_note(); !kept.empty()) warn_despite_quiet(kept);
}

void end_recorder(std::optional<Recorder>& recorder, const std::string& path) {
  if (!recorder) return;
  recorder->close();
  fmt::print("{}\n", path);
}

void replay_trajectory(ReplayOptions options, const std::string& command_line) {
  const std::vector<TrajectoryPoint> trajectory = read_trajectory(options.input);
  auto [bone, scan, exercise, entry_W_mm] =
      load_bone_to_mill(options.exercise, options.scan, options.milling.setup);
  warn_of_settings(options.milling.setup, bone.volume.geometry());
  const BoneDensities densities = estimate_densities(bone.volume);
  const std::uint64_t scan_hash = options.record.empty() ? 0 : fingerprint_of(bone.volume.grid());
  MillingSetup& setup = options.milling.setup;
  setup.guard = GuardSettings::for_simulation(setup.guard.limits, setup.guard.passivity_controller);
  MillingSession session(std::make_shared<Volume>(std::move(bone.volume)), densities, setup);
  Log log(options, trajectory.size(), session.volume());
  std::optional<Recorder> recorder;
  if (!options.record.empty()) {
    RunDescription run = describe_run(session.volume(), {bone.name, scan_hash}, {setup, densities},
                                      session.algorithm().sample_point_count(), command_line);
    std::ranges::move(scan_settings(scan), std::back_inserter(run.settings));
    if (exercise) put_exercise(run, *exercise);
    begin_recorder(recorder, options.record, run, Recorder::FirstSession::begins_at_once);
  }
  replay(session, trajectory, [&](const TickRecord& record) {
    log.add(record);
    if (recorder) recorder->push_waiting(record);
  });
  log.write();
  end_recorder(recorder, options.record);
}

// Restores the no-go structures of the recording's exercise if the burr was held off them.
void put_guards(const Recording& recording, Volume& bone) {
  const auto exercise = recorded_exercise(recording.description);
  if (!exercise || find_setting<double>(recording.description, kGuardsKey) == nullptr) return;
  if (text_fingerprint(exercise->file) != exercise->fingerprint) {
    throw InputError(exercise->file,
                     "has changed since " + recording.path.string() + " was made, which needs its guards");
  }
  bone.set_no_go(place_exercise(read_exercise_file(exercise->file), bone).distances);
}

// Reads the given scan, otherwise the recording's, with the recorded options.
Volume recorded_bone(const ReplayOptions& options, const Recording& recording) {
  LoadedBone bone = read_bone(scan_of(recording.description, options.scan));
  require_made_with(recording, bone.volume);
  const auto& labels = bone.volume.labels();
  if (labels && labels->fingerprint() != recording.description.label_map_hash)
    throw InputError(recording.path.string(), "was made with other labels");
  put_guards(recording, bone.volume);
  return std::move(bone.volume);
}

void verify(const Volume& scan, const Recording& recording) {
  const Verification verified = verify_recording(scan, recording, [&](std::size_t ticks) {
    if (ticks % 1000 == 0)
      show_progress("verify", static_cast<double>(ticks) / static_cast<double>(recording.records.size()));
  });
  end_progress();
  if (const auto& difference = verified.difference) {
    throw InputError(recording.path.string(),
                     fmt::format("differs from tick {} on ({:.3f} s): {}", difference->record,
                                 difference->time_s, difference->what));
  }
  fmt::print("same: {} ticks (wrenches, tool, milling), and the bone after {} of them\n", verified.ticks,
             verified.compared_bones);
}

// Returns the settings of the command line under this algorithm's name, so that they override the recorded
// ones.
HapticSettings settings_for(const AlgorithmDescription& algorithm, const HapticSettings& settings) {
  HapticSettings own;
  for (const HapticSettings::Named& named : settings.named) {
    if (!named.algorithm.empty()) {
      own.named.push_back(named);
    } else if (const SettingDescription* setting = setting_of_option(algorithm, named.setting)) {
      own.named.push_back({algorithm.id.name, setting->name, named.value});
    }
  }
  return own;
}

RunDescription run_as(const ReplayOptions& options, RunDescription run, const GridGeometry& scan) {
  const MillingSetup& given = options.milling.setup;
  const AlgorithmDescription* algorithm =
      options.is_given("--algorithm") ? &given.algorithm : find_algorithm(run.algorithm.name);
  if (algorithm == nullptr) return run;
  const HapticSettings chosen = settings_for(*algorithm, given.haptics);
  SessionSettings session = session_settings(run, options.input);
  MillingSetup& setup = session.setup;
  setup.algorithm = *algorithm;
  // Drops settings that were recorded for another algorithm.
  if (!(run.algorithm == algorithm->id)) setup.haptics = {};
  setup.haptics.named.insert(setup.haptics.named.end(), chosen.named.begin(), chosen.named.end());
  apply_given_options(*options.command, given, setup);
  warn_of_settings(setup, scan);
  set_session_settings(run, session, 0);
  return run;
}

void replay_with_changes(const ReplayOptions& options, const std::string& command_line, const Volume& scan,
                         const Recording& recording) {
  Log log(options, recording.records.size(), scan);
  std::optional<Recorder> recorder;
  std::uint32_t session_number = 0;
  ReplayHooks hooks;
  hooks.transform_description = [&](const RunDescription& run) {
    return run_as(options, run, scan.geometry());
  };
  hooks.on_session = [&](SessionStart start, const MillingSession& session) {
    if (options.record.empty()) return;
    for (RunSetting& setting : start.run.settings) {
      if (setting.key == kCommandLineKey) setting.value = command_line;
      if (setting.key == kSamplePointsKey)
        setting.value = static_cast<double>(session.algorithm().sample_point_count());
    }
    if (!recorder)
      begin_recorder(recorder, options.record, start.run, Recorder::FirstSession::begins_when_announced);
    recorder->begin_session(session_number++, std::move(start));
  };
  hooks.on_tick = [&](const TickRecord&, const TickRecord& now) {
    log.add(now);
    if (recorder) recorder->push_waiting(now);
    return true;
  };
  replay_recording(scan, recording, hooks);
  log.write();
  end_recorder(recorder, options.record);
}

// Begins a recording that continues another one in the same folder after a tick.
void begin_branch(std::optional<Recorder>& recorder, const ReplayOptions& options, const Recording& recording,
                  const BranchPoint& from, const std::string& command_line) {
  if (options.record.empty()) return;
  RunDescription run = recording.description;
  for (RunSetting& setting : run.settings)
    if (setting.key == kCommandLineKey) setting.value = command_line;
  put_branch_point(run, from);
  begin_recorder(recorder, options.record, run, Recorder::FirstSession::begins_when_announced);
  const std::string name = std::filesystem::path(from.recording).filename().string();
  recorder->begin_session(0, {.continues_from = name, .continues_after = from.ticks});
}

void require_same_folder(const ReplayOptions& options) {
  const auto folder_of = [](const std::string& file) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(file).parent_path());
  };
  if (!options.record.empty() && folder_of(options.record) != folder_of(options.from.recording))
    throw InputError(options.record,
                     "must be in the folder of " + options.from.recording + ", which it continues");
}

// Continues a recording at a tick along a trajectory, or without one, with its own remaining ticks.
void replay_from(const ReplayOptions& options, const std::string& command_line) {
  require_same_folder(options);
  const std::vector<TrajectoryPoint> trajectory =
      options.input.empty() ? std::vector<TrajectoryPoint>{} : read_trajectory(options.input);
  const Recording recording = read_recording_chain(options.from.recording);
  const Volume scan = recorded_bone(options, recording);
  ResumedRecording resumed = resume_recording(scan, recording, options.from.at_s);
  std::optional<Recorder> recorder;
  begin_branch(recorder, options, recording, {options.from.recording, resumed.ticks, resumed.last.time_s},
               command_line);
  Log log(options, trajectory.empty() ? recording.records.size() - resumed.ticks : trajectory.size(), scan);
  std::uint32_t session = 0;
  const auto add = [&](TickRecord record) {
    record.session = session;
    log.add(record);
    if (recorder) recorder->push_waiting(record);
  };
  if (!trajectory.empty()) {
    const double shift_s = resumed.last.time_s + resumed.last.dt_s - trajectory.front().time_s;
    replay(*resumed.session, trajectory, [&](TickRecord record) {
      record.time_s += shift_s;
      add(record);
    });
  } else {
    ReplayHooks hooks;
    hooks.on_session = [&](const SessionStart& start, const MillingSession&) {
      ++session;
      if (recorder) recorder->begin_session(session, start);
    };
    hooks.on_tick = [&](const TickRecord&, const TickRecord& now) {
      add(now);
      return true;
    };
    replay_rest(std::move(resumed), scan, recording, hooks);
  }
  log.write();
  end_recorder(recorder, options.record);
}

void run_replay(const ReplayOptions& options, const std::string& command_line) {
  if (!std::filesystem::exists(options.input)) throw InputError(options.input, "no such file");
  if (!is_hdf5(options.input)) {
    if (options.verify) throw InputError(options.input, "is not a recording, so there is nothing to verify");
    if (options.out.empty() && options.record.empty()) throw CLI::RequiredError("--out or --record");
    return replay_trajectory(options, command_line);
  }
  if (!options.verify && options.out.empty() && options.record.empty())
    throw CLI::RequiredError("--verify, --out or --record");
  const Recording recording = read_recording_chain(options.input);
  const Volume scan = recorded_bone(options, recording);
  if (options.verify) verify(scan, recording);
  if (!options.out.empty() || !options.record.empty())
    replay_with_changes(options, command_line, scan, recording);
}

// A recording can be replayed with another algorithm and its settings, but not with another tool or bone.
void refuse_recorded_settings(const ReplayOptions& options) {
  const auto refuse = [&](const std::string& option) {
    if (options.is_given(option))
      throw CLI::ValidationError(option, "is defined by the recording, and cannot be given");
  };
  for (const Field<ScanOptions>& option : fields_of<ScanOptions>()) refuse("--" + option.option);
  for (const char* option : {"--exercise", "--trainee"}) refuse(option);
  for (const Field<MillingSetup>& setting : fields_of<MillingSetup>()) {
    if (setting.has(kRecordedField)) refuse("--" + setting.option);
  }
}

}  // namespace

void add_replay_command(CLI::App& program, const std::string& command_line) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = program.add_subcommand(
      "replay", "Drive one algorithm along a trajectory, or replay a recording, and log every tick");
  options->command = command;
  command->group("Recordings");
  command
      ->add_option(
          "input", options->input,
          "Recording, or trajectory as CSV with the columns time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling; with "
          "--from only a trajectory, or nothing to repeat the rest of that recording")
      ->type_name("TRAJECTORY|RECORDING");
  add_scan_options(*command, options->scan,
                   "the scan of the recording, or for a trajectory the built-in tooth");
  add_exercise_options(*command, options->exercise);
  add_branch_options(*command, options->from);
  command->option_defaults()->group("The replay");
  command->add_flag("--verify", options->verify,
                    "Check that the recording replays bit for bit, or print the first tick that differs");
  add_algorithm_option(*command, options->milling.setup.algorithm);
  command->add_option("--out", options->out, "Log to write, as CSV with one row per tick")->type_name("FILE");
  command->add_option("--record", options->record, "Recording (HDF5) of the replayed motion to write")
      ->type_name("FILE");
  add_milling_options(*command, options->milling);
  add_quiet_option(*command);
  command->callback([=] {
    apply_config_file(*command);
    apply_implied_law(*command, options->milling.setup);
    if (options->from.given()) {
      refuse_recorded_options(*command);
      for (const char* option : {"--verify", "--exercise", "--trainee", "--force-limit", "--torque-limit",
                                 "--passivity-controller"})
        if (options->is_given(option)) throw CLI::ValidationError(option, "cannot be given with --from");
      if (options->out.empty() && options->record.empty()) throw CLI::RequiredError("--out or --record");
      return replay_from(*options, command_line);
    }
    if (options->input.empty()) throw CLI::RequiredError("input");
    if (is_hdf5(options->input)) refuse_recorded_settings(*options);
    run_replay(*options, command_line);
  });
}

}  // namespace osteomill::app
