#include "app/exercise_options.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <variant>

#include <CLI/Error.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "osteomill/base/input_error.h"
#include "osteomill/recording/replay_recording.h"

#include "app/exercise_file.h"
#include "app/option_checks.h"

namespace osteomill::app {

void add_exercise_options(CLI::App& command, ExerciseOptions& options) {
  command.option_defaults()->group("Exercise");
  command
      .add_option("--exercise", options.file,
                  "Exercise to work on (TOML, docs/exercises.md); it names the scan")
      ->check(not_empty())
      ->type_name("FILE");
  command
      .add_option("--trainee", options.trainee,
                  "Name of the trainee to store in recordings of the exercise (default: none)")
      ->check(not_empty())
      ->type_name("NAME");
}

void add_guidance_option(CLI::App& command, ExerciseOptions& options) {
  options.has_guidance = true;
  command.add_flag("--guidance,!--no-guidance", options.has_guidance,
                   "Show the exercise's steps, colours and distances, and record that they were shown; "
                   "--no-guidance hides them");
}

ScanOptions scan_of(const Exercise& exercise, const ScanOptions& options) {
  const auto refuse = [](const char* option) {
    throw CLI::ValidationError(option, "is defined by the exercise, and cannot be given with --exercise");
  };
  if (!options.scan.empty()) refuse("scan");
  if (options.isovalue) refuse("--iso");
  if (!options.labels.map.empty()) refuse("--labels");
  if (!options.labels.table.empty()) refuse("--label-table");
  const std::filesystem::path folder = exercise.file.parent_path();
  ScanOptions scan = options;
  scan.isovalue = exercise.isovalue;
  scan.scan = exercise.scan.starts_with("builtin:") ? exercise.scan : (folder / exercise.scan).string();
  if (!exercise.labels.empty()) scan.labels.map = folder / exercise.labels;
  if (!exercise.label_table.empty()) scan.labels.table = folder / exercise.label_table;
  return scan;
}

LoadedExercise load_exercise(const std::string& file, const ScanOptions& options,
                             const Recording* recording) {
  const Exercise exercise = read_exercise_file(file);
  ScanOptions scan = scan_of(exercise, options);
  if (recording != nullptr) scan.bone_fingerprint = recording->description.scan_hash;
  LoadedBone bone = load_bone(scan);
  if (recording != nullptr) require_made_with(*recording, bone.volume);
  PlacedExercise placed = place_exercise(exercise, bone.volume);
  bone.volume.set_no_go(placed.distances);
  for (const NoGoStructure& structure : exercise.no_go) {
    const auto* label = std::get_if<LabelShape>(&structure.region.shapes.front());
    if (label != nullptr && structure.region.shapes.size() == 1) scan.labels.no_go.push_back(label->label);
  }
  if (!scan.labels.no_go.empty() && !scan.labels.map.empty())
    bone.volume.set_labels(read_labels(scan.labels, bone.volume.geometry(), scan.read.max_memory_bytes).map);
  return {std::move(bone), std::move(placed)};
}

BoneToMill load_bone_to_mill(const ExerciseOptions& exercise, const ScanOptions& options,
                             const MillingSetup& setup) {
  if (!exercise.given()) return {load_bone(options), options, {}, {}};
  LoadedExercise loaded = load_exercise(exercise.file, options);
  const Exercise& task = loaded.placed.exercise;
  require_allowed_burr(task, setup);
  return {std::move(loaded.bone), scan_of(task, options), make_recorded_exercise(task, exercise),
          task.entry_W_mm};
}

void require_allowed_burr(const Exercise& exercise, const MillingSetup& setup) {
  const std::vector<AllowedBurr>& burrs = exercise.burrs;
  if (burrs.empty() || std::ranges::any_of(burrs, [&](const AllowedBurr& one) { return one.is_in(setup); }))
    return;
  std::vector<std::string> names;
  names.reserve(burrs.size());
  for (const AllowedBurr& one : burrs)
    names.push_back(one.named != nullptr ? one.named->name : fmt::format("{:g} mm radius", one.radius_mm));
  throw InputError(exercise.file.string(),
                   fmt::format("allows burrs of {}, not {:g} mm; --burr-name or --burr-radius sets one",
                               fmt::join(names, ", "), setup.tool.burr_radius_mm));
}

void select_allowed_burr(const Exercise& exercise, MillingSetup& setup) {
  const std::vector<AllowedBurr>& burrs = exercise.burrs;
  if (burrs.empty() || std::ranges::any_of(burrs, [&](const AllowedBurr& one) { return one.is_in(setup); }))
    return;
  const auto apart_mm = [own_mm = setup.tool.burr_radius_mm](const AllowedBurr& one) {
    return std::abs((one.named != nullptr ? one.named->tool.burr_radius_mm : one.radius_mm) - own_mm);
  };
  std::ranges::min_element(burrs, {}, apart_mm)->put_into(setup);
}

RecordedExercise make_recorded_exercise(const Exercise& exercise, const ExerciseOptions& options) {
  return {options.file, text_fingerprint(options.file), exercise.title, options.trainee,
          options.has_guidance};
}

}  // namespace osteomill::app
