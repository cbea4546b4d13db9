#include "app/study_trials.h"

#include <algorithm>
#include <new>
#include <stdexcept>

#include "app/config_file.h"
#include "app/option_checks.h"
#include "app/progress.h"
#include "app/study_file.h"
#include "app/toml_file.h"
#include <fmt/format.h>

#include "osteomill/experiment/match_stiffness.h"
#include "osteomill/files/input_error.h"

namespace osteomill::app {

namespace {

constexpr const char* kBuiltIn = "built-in";
constexpr std::size_t kBonesKept = 8;
// Options that the command has and a trial cannot have.
constexpr std::string_view kNoKeys[] = {"--help", "--config", "--set", "--max-memory"};

std::string option_name(const std::string& key) {
  return key == "scan" ? key : "--" + key;
}

std::string tool_text(const MillingTool& tool) {
  return fmt::format("{} {} {}", tool.burr_radius_mm, tool.shaft_radius_mm, tool.shaft_length_mm);
}

// Throws std::invalid_argument where the trial itself would when it begins: a setting is out of its range, or
// does not go with the bone.
void require_runnable(StudyTest test, const TrialPlan& trial) {
  const TrialSettings& settings = trial.settings;
  setting_values(settings.algorithm, settings.haptics);
  if (test != StudyTest::milling) {
    require_valid(settings.hand_and_device.handle);
    if (setting_of_option(settings.algorithm, kStiffnessOption) == nullptr)
      throw std::invalid_argument(settings.algorithm.id.name + " has no stiffness");
    return;
  }
  require_workable(settings.tool, trial.bone.geometry());
  milling_settings(settings);
  SimulatedOperator(settings.hand_and_device, settings.tool, trial.entry);
}

}  // namespace

StudyTrials::StudyTrials(const std::string& file, std::filesystem::path scans_from)
    : file_(file), scans_from_(std::move(scans_from)), command_("", "a study"), design_(read_design()) {}

StudyDesign StudyTrials::read_design() {
  add_scan_options(command_, asked_.scan);
  command_.add_option("--voxel", asked_.voxel_mm, "Of the built-in tooth")
      ->check(CLI::Range(0.03, 1.0))
      ->type_name("mm");
  command_.option_defaults()->group("A study");
  add_algorithm_option(command_, asked_.trial.milling.setup.algorithm);
  command_.add_option("--rate", asked_.rate_hz, "Of the haptic loop")
      ->check(CLI::Range(100.0, 20000.0))
      ->type_name("Hz");
  add_positive(command_, "--device-damping", asked_.device_damping_Ns_per_mm, "N.s/mm",
               "Of the device, on a wall");
  add_positive(command_, "--grip", asked_.grip, "", "How many times as firmly the hand grips");
  command_.add_flag("--draw-hand", asked_.draw_hand, "The seed draws the hand");
  add_trial_options(command_, asked_.trial);
  check_values(command_);
  StudyDesign design = read_study_file(file_, keys());
  design.units = units();
  return design;
}

std::vector<std::string> StudyTrials::keys() const {
  std::vector<std::string> keys{"scan"};
  for (const std::string& name : option_names(command_))
    if (std::ranges::find(kNoKeys, name) == std::end(kNoKeys)) keys.push_back(name.substr(2));
  return keys;
}

StudySettings StudyTrials::units() const {
  StudySettings units;
  for (const std::string& key : keys()) {
    // The option's type is its unit, or a word for what it takes ("FILE"); CLI11 appends what it checks,
    // behind a colon.
    const std::string type = command_.get_option(option_name(key))->get_type_name(),
                      unit = type.substr(0, type.find(':'));
    const bool is_word = unit.find_first_of("|,") != std::string::npos || unit == "NUMBER" ||
                         unit == "COUNT" || unit == "NAME" || unit == "MODE" || unit == "TEXT" ||
                         unit == "FILE";
    if (key != "scan" && !is_word) units.emplace_back(key, unit);
  }
  return units;
}

void StudyTrials::take(const StudySettings& settings) {
  asked_ = Asked();
  asked_.trial.hand.script.until_leant = true;
  std::vector<std::string> named;
  for (const auto& [key, text] : settings) {
    if (is_own_setting(key)) {
      named.push_back(key + "=" + text);
    } else if (key != "scan" || text != kBuiltIn) {
      set_option(command_, option_name(key), {text});
    }
  }
  for (const auto& [key, text] : settings)
    if (asked_.draw_hand && key.starts_with("hand-"))
      throw std::invalid_argument("draw-hand draws what " + key + " sets");
  if (!named.empty()) set_option(command_, "--set", named);
  if (!asked_.scan.scan.empty()) asked_.scan.scan = (scans_from_ / asked_.scan.scan).string();
  asked_.scan.refinement = Asked().voxel_mm / asked_.voxel_mm;
}

StudyTrials::Bone& StudyTrials::bone_of(const StudySettings& settings) {
  std::string key;
  for (const auto& [name, text] : settings)
    if (!is_own_setting(name) && command_.get_option(option_name(name))->get_group() == "Scan")
      key += fmt::format("{}{}={}", key.empty() ? "" : " ", name, text);
  std::unique_ptr<Bone>& bone = bones_[key];
  if (bone) return *bone;
  LoadedBone loaded = read_bone(asked_.scan);
  const BoneDensities densities = estimate_densities(loaded.volume);
  const std::uint64_t fingerprint = fingerprint_of(loaded.volume.grid());
  const auto [expected, is_new] = fingerprints_.emplace(key, fingerprint);
  if (expected->second != fingerprint) throw InputError(loaded.name, "has changed since the study was begun");
  if (is_new)
    for (const std::string& warning : loaded.warnings) warn(warning);
  bone = std::make_unique<Bone>(Bone{std::move(loaded.volume), std::move(loaded.name), densities, {}});
  return *bone;
}

const Volume& StudyTrials::wall_of(const MillingTool& tool) {
  const std::string key = tool_text(tool);
  const auto found = walls_.find(key);
  return found != walls_.end() ? found->second : walls_.emplace(key, flat_wall(tool)).first->second;
}

TrialPlan StudyTrials::trial_of(const StudySettings& settings) {
  take(settings);
  TrialSettings set = trial_settings(asked_.trial);
  set.tick_s = 1 / asked_.rate_hz;
  set.device_damping_Ns_per_mm = asked_.device_damping_Ns_per_mm;
  if (design_.test != StudyTest::milling) return {wall_of(set.tool), "a wall", {}, {}, set, ""};
  Bone& bone = bone_of(settings);
  const auto numbers = [](const std::vector<double>& values) {
    return fmt::format("{}", fmt::join(values, ","));
  };
  const std::string place =
      tool_text(set.tool) + " " + numbers(asked_.trial.entry_mm) + " " + numbers(asked_.trial.direction);
  auto entry = bone.entries.find(place);
  if (entry == bone.entries.end())
    entry = bone.entries.emplace(place, entry_into(bone.volume, asked_.trial)).first;
  const TrialPlan as_set{bone.volume, bone.name, bone.densities, entry->second, set, "", true};
  TrialPlan plan = asked_.draw_hand ? with_seed(as_set, asked_.trial.milling.seed) : as_set;
  plan.grip = asked_.grip;
  HandSettings& hand = plan.settings.hand_and_device.hand;
  hand = gripping(hand, asked_.grip);
  return plan;
}

std::vector<TrialPlan> StudyTrials::make(std::size_t first, std::size_t count) {
  if (bones_.size() > kBonesKept) bones_.clear();
  std::vector<TrialPlan> trials;
  for (std::size_t number = first; number < first + count; ++number) {
    try {
      trials.push_back(trial_of(design_.trial(number)));
      require_runnable(design_.test, trials.back());
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      throw InputError(file_, fmt::format("trial {}: {}", number, error.what()));
    }
  }
  return trials;
}

}  // namespace osteomill::app
