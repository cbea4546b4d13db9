#include "app/trial_options.h"

#include <limits>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "osteomill/base/csv_field.h"
#include "osteomill/base/parse_number.h"

#include "app/option_checks.h"
#include "app/progress.h"

namespace osteomill {

using app::TrialOptions;

namespace {

// Parses a vector: "0,0,-1".
Vec3 three_numbers(const std::string& text) {
  const std::vector<std::string_view> parts = csv_fields(text);
  Vec3 numbers;
  for (std::size_t n = 0; n < 3; ++n) {
    const auto number = n < parts.size() ? parse_finite(parts[n]) : std::nullopt;
    if (!number || parts.size() != 3) throw std::invalid_argument(text + " is not three numbers, X,Y,Z");
    numbers[static_cast<Eigen::Index>(n)] = *number;
  }
  return numbers;
}

Field<TrialOptions, std::string> vector_field(const char* option, std::optional<Vec3> TrialOptions::*place,
                                              const char* doc) {
  return {{"", "X,Y,Z", NumberRange::count(3, 3), doc, 0, option},
          [place](const TrialOptions& s) {
            const auto& v = s.*place;
            return v ? fmt::format("{},{},{}", v->x(), v->y(), v->z()) : "";
          },
          [place](TrialOptions& s, const std::string& text) { s.*place = three_numbers(text); }};
}

}  // namespace

template <>
const std::vector<Field<TrialOptions, std::string>>& fields_of<TrialOptions, std::string>() {
  static const std::vector<Field<TrialOptions, std::string>> all{
      vector_field("entry", &TrialOptions::entry_W_mm,
                   "Point at which the tool enters the bone, mm (default: the top of the bone)"),
      vector_field("direction", &TrialOptions::direction_W,
                   "Direction in which the tool enters the bone (default: 0,0,-1)")};
  return all;
}

}  // namespace osteomill

namespace osteomill::app {

void add_trial_options(CLI::App& command, TrialOptions& options) {
  command.option_defaults()->group("The hand and its device");
  add_texts(command, options);
  add_fields(command, options.hand);
  command.add_option("--seed", options.seed, "Seed of the simulated hand's tremor")
      ->check(whole_number(0, std::numeric_limits<std::uint64_t>::max()))
      ->type_name("NUMBER")
      ->capture_default_str();
  add_milling_options(command, options.milling);
}

TrialSettings trial_settings(const TrialOptions& options) {
  TrialSettings trial(options.milling.setup, options.hand);
  trial.hand_and_device.handle.limits = trial.guard.limits;
  trial.hand_and_device.seed = options.seed;
  return trial;
}

MillingEntry entry_into(const Volume& bone, const std::string& scan, const TrialOptions& options) {
  return osteomill::place_entry(bone, options.milling.setup.tool, options.entry_W_mm, options.direction_W,
                                scan);
}

MillingEntry place_entry(const Volume& bone, const std::string& scan, const TrialOptions& options) {
  const MillingEntry entry = entry_into(bone, scan, options);
  for (const std::string& warning : entry_warnings(bone, options.milling.setup.tool, entry)) warn(warning);
  return entry;
}

void warn_of_settings(const MillingSetup& setup, const GridGeometry& scan) {
  for (const std::string& warning : setting_warnings(setup, scan)) warn(warning);
}

TrialPlan trial_plan(const LoadedBone& bone, const TrialOptions& options, const std::string& command_line) {
  require_workable(options.milling.setup.tool, bone.volume.geometry());
  return {bone.volume,
          {bone.name, fingerprint_of(bone.volume.grid())},
          estimate_densities(bone.volume),
          place_entry(bone.volume, bone.name, options),
          trial_settings(options),
          command_line};
}

}  // namespace osteomill::app
