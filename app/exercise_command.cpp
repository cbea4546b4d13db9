#include <array>
#include <memory>
#include <string>

#include <CLI/Error.hpp>
#include <fmt/core.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/exercise/measures.h"

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

}  // namespace

void add_exercise_command(CLI::App& program) {
  auto options = std::make_shared<ExerciseCommandOptions>();
  CLI::App* command = program.add_subcommand(
      "exercise", "Check an exercise file, and print its target, structures, steps and items");
  command->group("Exercises");
  command->add_option("file", options->file, "Exercise file (TOML, docs/exercises.md)");
  command->add_flag("--check", options->check,
                    "Print the contents of the exercise, or its first fault with the line");
  command
      ->add_option(
          "--picture", options->picture,
          "Picture (PNG) to draw; the start page shows a picture in the exercise's folder with the same name")
      ->type_name("FILE");
  command->add_flag("--measures", options->measures,
                    "Print all measures that items can use, as a Markdown table");
  add_quiet_option(*command);
  command->callback([=] { run_exercise(*options); });
}

}  // namespace osteomill::app
