#include <array>
#include <filesystem>
#include <memory>
#include <string>

#include <CLI/Error.hpp>
#include <fmt/core.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/file_lock.h"
#include "osteomill/base/input_error.h"
#include "osteomill/exercise/measures.h"
#include "osteomill/exercise/recorded_exercise.h"

#include "app/commands.h"
#include "app/exercise_options.h"
#include "app/exercise_picture.h"
#include "app/progress.h"

namespace osteomill::app {

namespace {

struct ExerciseCommandOptions {
  std::string file;
  bool check = false;
  bool measures = false;
  std::string picture;
};

void run_exercise(const ExerciseCommandOptions& options) {
  if (options.measures) {
    fmt::print("{}", measures_table());
    if (options.file.empty()) return;
  }
  if (options.file.empty()) throw CLI::RequiredError("file");
  if (!options.check && options.picture.empty()) throw CLI::RequiredError("--check or --picture");
  const auto [bone, placed] = load_exercise(options.file, {});
  if (!options.picture.empty()) {
    output_path(options.picture);
    constexpr PixelSize kStartPage{300, 240};
    write_png(options.picture, exercise_picture(placed, bone.volume, kStartPage));
    fmt::print("{}\n", options.picture);
  }
  if (!options.check) return;
  const std::array<int, 3>& dims = bone.volume.geometry().dims;
  const std::vector<std::string> lines = describe(placed);
  fmt::print("{}\nscan: {}, {} x {} x {} voxels, isovalue {:g}\n", lines.front(), bone.name, dims[0], dims[1],
             dims[2], bone.volume.isovalue());
  for (std::size_t n = 1; n < lines.size(); ++n) fmt::print("{}\n", lines[n]);
}

struct DebriefOptions {
  std::string recording;
  std::string exercise;
  std::string out;
};

// Returns the exercise's file: the one that is named, else the recording's.
std::string exercise_of(const DebriefOptions& options, const Recording& recording) {
  const auto recorded = recorded_exercise(recording.description);
  if (!recorded && options.exercise.empty())
    throw InputError(options.recording, "was made without an exercise; --exercise names one");
  std::string file = options.exercise.empty() ? recorded->file : options.exercise;
  if (recorded && text_fingerprint(file) != recorded->fingerprint) {
    warn(fmt::format("{}: is not the exercise as it was when {} was recorded ({})", file, options.recording,
                     recorded->title));
  }
  return file;
}

std::string row_text(const MeasuredValue& row) {
  std::string text = row.measure + ": ";
  text += row.value ? fmt::format("{:.4g}", *row.value) : "not measured";
  if (row.value && !row.unit.empty()) text += " " + row.unit;
  if (row.is_met) text += fmt::format(", {} ({})", row.limit, *row.is_met ? "met" : "not met");
  return text;
}

void run_debrief(const DebriefOptions& options) {
  const Recording recording = read_recording_chain(options.recording);
  const auto [bone, placed] = load_exercise(exercise_of(options, recording), {}, &recording);
  const Attempt attempt = make_attempt(placed, bone.volume, recording);
  const std::vector<MeasuredValue> rows = measure_attempt(attempt);
  const std::filesystem::path folder = options.out;
  const OutputFolder held(folder);
  write_folder_atomically(folder, [&](const std::filesystem::path& beside) {
    write_measured(beside / "debrief.csv", rows);
    write_progress(beside / "progress.csv", attempt);
  });
  fmt::print("{}\n", placed.exercise.title);
  if (const auto from = branch_point(recording.description))
    fmt::print("goes on from {} at {:.3f} s, after {} ticks\n", from->recording, from->time_s, from->ticks);
  for (const MeasuredValue& row : rows)
    if (!row.limit.empty()) fmt::print("{}\n", row_text(row));
  fmt::print("{}\n", (folder / "debrief.csv").string());
}

}  // namespace

void add_exercise_command(CLI::App& program) {
  auto options = std::make_shared<ExerciseCommandOptions>();
  CLI::App* command =
      program.add_subcommand("exercise", "Check an exercise: its target, structures, steps and items");
  command->group("Exercises");
  command->add_option("file", options->file, "The exercise, TOML; docs/exercises.md");
  command->add_flag("--check", options->check, "Print what it holds, or the first fault with its line");
  command
      ->add_option(
          "--picture", options->picture,
          "Picture to draw for the start page, PNG; there it stands beside the exercise under its name")
      ->type_name("FILE");
  command->add_flag("--measures", options->measures, "Print all measures as a Markdown table");
  add_quiet_option(*command);
  command->callback([=] { run_exercise(*options); });
}

void add_debrief_command(CLI::App& program) {
  auto options = std::make_shared<DebriefOptions>();
  CLI::App* command =
      program.add_subcommand("debrief", "Measure a recorded session against its exercise, as a CSV table");
  command->group("Exercises");
  command->add_option("recording", options->recording, "The recording (.h5)")->required();
  command
      ->add_option("--exercise", options->exercise, "Exercise to measure by (default: the recording's own)")
      ->type_name("FILE");
  command->add_option("--out", options->out, "Folder for debrief.csv")->required()->type_name("FOLDER");
  add_quiet_option(*command);
  command->callback([=] { run_debrief(*options); });
}

}  // namespace osteomill::app
