#include "app/branch_options.h"

#include <utility>

#include <CLI/Error.hpp>

#include "osteomill/base/input_error.h"
#include "osteomill/base/work_progress.h"

#include "app/milling_options.h"
#include "app/option_checks.h"

namespace osteomill::app {

void add_branch_options(CLI::App& command, BranchOptions& options) {
  command.option_defaults()->group("Continuing a recording");
  CLI::Option* from = command
                          .add_option("--from", options.recording,
                                      "Recording to continue, with its bone, tool, settings and clock")
                          ->check(not_empty())
                          ->type_name("RECORDING");
  CLI::Option* at =
      command.add_option("--at", options.at_s, "Time in that recording at which to continue, s")
          ->check(number_of(NumberRange::finite()))
          ->type_name("SECONDS");
  from->needs(at);
  at->needs(from);
}

void refuse_recorded_options(const CLI::App& command) {
  const auto refuse = [&](const std::string& option) {
    const CLI::Option* const there = command.get_option_no_throw(option);
    if (there != nullptr && there->count() > 0)
      throw CLI::ValidationError(option, "is defined by the recording, and cannot be given with --from");
  };
  for (const char* option : {"--algorithm", "--set", "--rate"}) refuse(option);
  for (const std::string& option : shared_options()) refuse("--" + option);
  for (const Field<ScanOptions>& field : fields_of<ScanOptions>()) refuse("--" + field.option);
  for (const Field<MillingSetup>& field : fields_of<MillingSetup>())
    if (!field.option.empty() && !field.has(kLimitField)) refuse("--" + field.option);
}

LoadedRecording load_recording(const std::string& recording, const ScanOptions& scan,
                               const ExerciseOptions& exercise) {
  Recording read = read_recording_chain(recording);
  const std::optional<RecordedExercise> recorded = recorded_exercise(read.description);
  if (recorded || exercise.given()) {
    ExerciseOptions asked = exercise;
    if (!asked.given()) asked.file = recorded->file;
    if (asked.trainee.empty() && recorded) asked.trainee = recorded->trainee;
    LoadedExercise loaded = load_exercise(asked.file, scan, &read);
    const Exercise& task = loaded.placed.exercise;
    const ScanOptions of_task = scan_of(task, scan);
    const RecordedExercise again = make_recorded_exercise(task, asked);
    return {std::move(read), std::move(loaded.bone), of_task, std::move(loaded.placed), again};
  }
  const ScanOptions of_recording = scan_of(read.description, scan);
  LoadedBone bone = load_bone(of_recording);
  require_made_with(read, bone.volume);
  if (const auto& labels = bone.volume.labels();
      labels && labels->fingerprint() != read.description.label_map_hash)
    throw InputError(recording, "was made with other labels");
  return {std::move(read), std::move(bone), of_recording, std::nullopt, std::nullopt};
}

Branch open_branch(const BranchOptions& options, const ScanOptions& scan, const ExerciseOptions& exercise) {
  LoadedRecording work = [&] {
    const WorkProgress::Part reading(0.3);
    return load_recording(options.recording, scan, exercise);
  }();
  const WorkProgress::Part replaying(1);
  const std::size_t ticks = ticks_until(work.recording, options.at_s);
  ResumedRecording resumed =
      resume_recording(work.bone.volume, work.recording, options.at_s, [&](std::size_t done) {
        if (done % 1000 == 0) WorkProgress::done(done, ticks);
      });
  const BranchPoint from{options.recording, resumed.ticks, resumed.last.time_s};
  return {std::move(work), std::move(resumed), from};
}

}  // namespace osteomill::app
