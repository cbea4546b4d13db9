#include "app/study_trials.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"
#include "osteomill/study/match_stiffness.h"
#include "osteomill/study/probe_bones.h"
#include "osteomill/study/study_slices.h"

#include "app/option_checks.h"
#include "app/progress.h"
#include "app/study_file.h"
#include "app/toml_file.h"

namespace osteomill::app {

namespace {

constexpr const char* kBuiltIn = "built-in";
constexpr std::size_t kMaxBones = 8;

using Text = Field<TrialSpec, std::string>;

std::string tool_text(const MillingTool& tool) {
  return fmt::format("{} {} {}", tool.burr_radius_mm, tool.shaft_radius_mm, tool.shaft_length_mm);
}

// Returns warnings about poor settings. Throws std::invalid_argument as the trial itself would at its start:
// if a setting is out of range or incompatible with the bone.
std::vector<std::string> trial_warnings(StudyTest test, const TrialPlan& trial) {
  const TrialSettings& settings = trial.settings;
  if (test != StudyTest::milling) {
    require_valid(settings.hand_and_device.handle);
    if (setting_of_option(settings.algorithm, kStiffnessOption) == nullptr)
      throw std::invalid_argument(settings.algorithm.id.name + " has no stiffness");
    // Only contact with the wall matters, so the shaft may be wider than the grid.
    return make_algorithm(settings.algorithm, settings.haptics)
        ->setting_warnings(settings.tool, trial.bone.geometry());
  }
  milling_settings(settings);
  SimulatedOperator(settings.hand_and_device, settings.tool, trial.entry);
  return setting_warnings(settings, trial.bone.geometry());
}

std::vector<Text> trial_texts() {
  using A = TrialSpec;
  const Text scan{{"", "", {}, "", kBoneField, "scan"},
                  [](const A& a) { return a.scan.scan.empty() ? kBuiltIn : a.scan.scan; },
                  [](A& a, const std::string& name) { a.scan.scan = name == kBuiltIn ? "" : name; }};
  const Text algorithm{{"", "", {}, "", 0, "algorithm"},
                       [](const A& a) { return a.trial.milling.setup.algorithm.id.name; },
                       [](A& a, const std::string& name) {
                         require_word("algorithm", name, algorithm_names());
                         a.trial.milling.setup.algorithm = algorithm_named(name);
                       }};
  return joined<A, std::string>({{scan},
                                 fields_within<A>(&A::scan, fields_of<ScanOptions, std::string>()),
                                 {algorithm},
                                 fields_within<A>(&A::trial, fields_of<TrialOptions, std::string>())});
}

std::vector<Field<TrialSpec>> trial_numbers() {
  // A double represents every whole number up to this.
  constexpr double kMaxSeed = 1ull << 53;
  using A = TrialSpec;
  const std::vector<Field<A>> own{
      field<A>({"", "mm", {0.03, 1}, "Voxel size of the built-in tooth", kBoneField, "voxel"}, &A::voxel_mm),
      field<A>({"", "Hz", {100, 20000}, "Rate of the haptic loop", 0, "rate"}, &A::rate_hz),
      field<A>(
          {"", "N s/mm", NumberRange::positive(), "Damping of the device on a wall", 0, "device-damping"},
          &A::device_damping_Ns_per_mm),
      field<A>({"", "", NumberRange::positive(),
                "Factor by which the hand's stiffness and damping are multiplied", 0, "grip"},
               &A::grip),
      field<A>({"", "", NumberRange::on_or_off(), "Draw the hand at random from the seed", 0, "draw-hand"},
               &A::draw_hand),
      field<A>(
          {"", "", {0, kMaxSeed, true}, "Seed of the hand's tremor", 0, "seed"},
          [](auto& a) -> auto& { return a.trial.seed; })};
  std::vector<Field<A>> all =
      joined<A>({fields_within<A>(&A::scan, fields_of<ScanOptions>()), own,
                 fields_within<A>(
                     [](auto& a) -> auto& { return a.trial.milling.setup; }, fields_of<MillingSetup>()),
                 fields_within<A>(
                     [](auto& a) -> auto& { return a.trial.hand; }, fields_of<OperatorSettings>())});
  std::erase_if(all, [](const Field<A>& one) { return one.option.empty(); });
  return all;
}

void set_one(TrialSpec& asked, const std::string& key, const std::string& text) {
  HapticSettings& haptics = asked.trial.milling.setup.haptics;
  if (text.empty()) throw std::invalid_argument(key + " is empty");
  if (is_algorithm_setting(key)) {
    set_algorithm_setting(haptics, key, text);
  } else if (const Field<TrialSpec>* number = field_of_option(trial_number_fields(), key)) {
    number->set(asked, value_of(*number, text));
  } else if (const Text* known = field_of_option(trial_text_fields(), key)) {
    known->set(asked, text);
  } else {
    set_shared_option(haptics, key, value_of({"", "", NumberRange::finite(), "", 0, key}, text));
  }
}

// Returns the options of a trial with their units.
StudySettings options_and_units() {
  StudySettings options;
  for (const Text& text : trial_text_fields()) options.emplace_back(text.option, "");
  for (const Field<TrialSpec>& number : trial_number_fields())
    options.emplace_back(number.option, number.unit);
  for (const std::string& option : shared_options()) options.emplace_back(option, "");
  return options;
}

StudyDesign read_design(const std::string& file) {
  const StudySettings options = options_and_units();
  std::vector<std::string> keys;
  for (const auto& [option, unit] : options) keys.push_back(option);
  StudyDesign design = read_study_file(file, keys);
  design.units = options;
  return design;
}

}  // namespace

const std::vector<Field<TrialSpec>>& trial_number_fields() {
  static const std::vector<Field<TrialSpec>> all = trial_numbers();
  return all;
}

const std::vector<Text>& trial_text_fields() {
  static const std::vector<Text> all = trial_texts();
  return all;
}

TrialSpec trial_spec(const StudySettings& settings) {
  TrialSpec asked;
  asked.trial.hand.script.until_leant = true;
  for (const auto& [key, text] : settings) set_one(asked, key, text);
  for (const auto& [key, text] : settings)
    if (asked.draw_hand && key.starts_with("hand-"))
      throw std::invalid_argument("draw-hand draws the hand, so " + key + " cannot be set");
  asked.scan.refinement = TrialSpec().voxel_mm / asked.voxel_mm;
  return asked;
}

std::string bone_key(const TrialSpec& asked) {
  std::string words;
  const auto add = [&](const FieldDescription& field, const std::string& value) {
    if (field.has(kBoneField)) words += fmt::format("{}{}={}", words.empty() ? "" : " ", field.option, value);
  };
  for (const Text& text : trial_text_fields()) add(text, text.get(asked));
  for (const Field<TrialSpec>& number : trial_number_fields())
    add(number, fmt::format("{}", number.get(asked)));
  return words;
}

StudyTrials::StudyTrials(const std::string& file, std::filesystem::path scans_from)
    : file_(file), scans_from_(std::move(scans_from)), design_(read_design(file)) {}

StudyTrials::Bone& StudyTrials::bone_of(const TrialSpec& asked) {
  const std::string words = bone_key(asked);
  std::unique_ptr<Bone>& bone = bones_[words];
  if (bone) return *bone;
  ScanOptions scan = asked.scan;
  if (!scan.scan.empty()) scan.scan = (scans_from_ / scan.scan).string();
  LoadedBone loaded = read_bone(scan);
  const BoneDensities densities = estimate_densities(loaded.volume);
  const std::uint64_t fingerprint = fingerprint_of(loaded.volume.grid());
  const auto [expected, is_new] = fingerprints_.emplace(words, fingerprint);
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
  const TrialSpec asked = trial_spec(settings);
  TrialSettings set = trial_settings(asked.trial);
  set.tick_s = 1 / asked.rate_hz;
  set.device_damping_Ns_per_mm = asked.device_damping_Ns_per_mm;
  if (design_.test != StudyTest::milling) return {wall_of(set.tool), {"a wall", 0}, {}, {}, set, ""};
  Bone& bone = bone_of(asked);
  std::string place = tool_text(set.tool);
  for (const auto& text : fields_of<TrialOptions, std::string>()) place += " " + text.get(asked.trial);
  auto entry = bone.entries.find(place);
  if (entry == bone.entries.end())
    entry = bone.entries.emplace(place, entry_into(bone.volume, bone.name, asked.trial)).first;
  const TrialPlan as_set{bone.volume, {bone.name, 0}, bone.densities, entry->second, set, ""};
  TrialPlan plan = asked.draw_hand ? with_seed(as_set, asked.trial.seed) : as_set;
  plan.grip = asked.grip;
  HandSettings& hand = plan.settings.hand_and_device.hand;
  hand = with_firmer_grip(hand, asked.grip);
  return plan;
}

std::string StudyTrials::settings_warning() const {
  if (warned_trials_.size() < 2) return first_warning_;
  return fmt::format("{}; {} trials have such warnings", first_warning_, warned_trials_.size());
}

std::vector<TrialPlan> StudyTrials::make(std::size_t first, std::size_t count) {
  if (bones_.size() > kMaxBones) bones_.clear();
  std::vector<TrialPlan> trials;
  for (std::size_t number = first; number < first + count; ++number) {
    try {
      trials.push_back(trial_of(design_.trial(number)));
      const std::vector<std::string> warnings = trial_warnings(design_.test, trials.back());
      if (!warnings.empty() && warned_trials_.insert(number).second && warned_trials_.size() == 1)
        first_warning_ = fmt::format("{}: trial {}: {}", file_, number, warnings.front());
    } catch (...) {
      rethrow_with_trial(file_, number);
    }
  }
  return trials;
}

}  // namespace osteomill::app
