#include "app/milling_options.h"

#include <filesystem>
#include <fstream>

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

#include "osteomill/recording/run_description.h"
#include "osteomill/study/trial_plan.h"

#include "app/config_file.h"
#include "app/trial_options.h"
#include "tests/shapes.h"
#include "tests/support/recording_samples.h"

namespace osteomill::app {
namespace {

// Returns arguments that set the option to another value than its default.
std::vector<std::string> words_for(const CLI::Option& option) {
  const std::string name = option.get_name();
  if (option.get_expected_max() == 0) return {name};
  // Takes the last name of a choice.
  if (const std::string type = option.get_type_name(); type.find('|') != type.npos)
    return {name, type.substr(type.rfind('|') + 1)};
  if (name == "--direction") return {name, "0.1,0,-1"};
  if (option.get_type_name() == "X,Y,Z") return {name, "0.5,0,20"};
  if (option.get_type_name() == "SETTING") return {name, "point-shell.damping-time=0.002"};
  if (name == "--chip-exponent") return {name, "0.5"};
  if (name == "--burr-name") return {name, "diamond-2"};
  return {name, name == "--push" ? "2.5" : "4"};
}

void parse(CLI::App& command, std::vector<std::string> words) {
  std::ranges::reverse(words);
  command.parse(std::move(words));
}

// Returns the recorded settings of runs with all algorithms.
std::vector<RunSetting> recorded(const std::vector<std::string>& words) {
  CLI::App command;
  TrialOptions options;
  add_trial_options(command, options);
  parse(command, words);
  const Volume bone = testing_support::shape_volume(testing_support::centred_cube(60, 0.25),
                                                    testing_support::ball(Vec3::Zero(), 5));
  TrialPlan plan{bone, {"", 0}, {0, 1000}, place_entry(bone, "a ball", options), trial_settings(options), ""};
  std::vector<RunSetting> all;
  for (const AlgorithmDescription& algorithm : all_algorithms()) {
    plan.settings.algorithm = algorithm;
    const RunDescription run = describe_trial(plan, 0, "milling");
    all.insert(all.end(), run.settings.begin(), run.settings.end());
    all.push_back({"burr", run.tool.burr_radius_mm, "mm"});
    all.push_back({"shaft", run.tool.shaft_radius_mm, "mm"});
    all.push_back({"length", run.tool.shaft_length_mm, "mm"});
    all.push_back({"seed", static_cast<double>(run.seed), ""});
  }
  return all;
}

TEST(MillingOptions, RecordsEveryOptionOfATrial) {
  CLI::App command;
  TrialOptions options;
  add_trial_options(command, options);
  const std::vector<RunSetting> usual = recorded({});
  std::size_t walked = 0;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_name() == "--help" || option->get_name() == "--config") continue;
    EXPECT_NE(recorded(words_for(*option)), usual) << option->get_name();
    ++walked;
  }
  EXPECT_GT(walked, 25u);
}

TEST(MillingOptions, ConstantEnergyOptionsImplyTheirLawAndRefuseAnother) {
  const auto law_after = [](const std::vector<std::string>& words) {
    CLI::App command;
    MillingOptions options;
    options.setup.law = CuttingLaw::chips;
    add_milling_options(command, options);
    parse(command, words);
    apply_implied_law(command, options.setup);
    return options.setup.law;
  };
  EXPECT_EQ(law_after({}), CuttingLaw::chips);
  EXPECT_EQ(law_after({"--removal-rate", "3"}), CuttingLaw::constant_energy);
  EXPECT_EQ(law_after({"--cutting-energy", "700", "--law", "constant-energy"}), CuttingLaw::constant_energy);
  EXPECT_THROW(law_after({"--law", "chips", "--removal-rate", "3"}), CLI::ValidationError);
  EXPECT_THROW(law_after({"--law", "chip"}), CLI::ValidationError);
}

TEST(MillingOptions, CommandLineRadiusOverridesTheBurrOfAConfigFile) {
  const testing_support::TestFolder folder;
  const std::filesystem::path file = folder / "c.toml";
  std::ofstream(file) << "burr-name = \"diamond-2.5\"\n";
  CLI::App command;
  MillingOptions options;
  add_milling_options(command, options);
  parse(command, {"--burr-radius", "2", "--config", file.string()});
  apply_config_file(command);
  EXPECT_EQ(options.setup.tool.burr_radius_mm, 2);
  EXPECT_EQ(options.setup.burr, BurrEdge::diamond);
}

TEST(MillingOptions, CopiesOnlyGivenOptions) {
  const auto settings_after = [](const std::vector<std::string>& words) {
    CLI::App command;
    MillingOptions options;
    add_milling_options(command, options);
    parse(command, words);
    MillingSetup setup;
    setup.tool.burr_radius_mm = 1.25;
    apply_given_options(command, options.setup, setup);
    RunDescription run;
    set_session_settings(run, {setup, {0, 1000}}, 0);
    EXPECT_EQ(run.tool.burr_radius_mm, 1.25);
    return run.settings;
  };
  const std::vector<RunSetting> usual = settings_after({});
  CLI::App command;
  MillingOptions options;
  add_milling_options(command, options);
  for (const Field<MillingSetup>& field : fields_of<MillingSetup>()) {
    if (field.option.empty() || field.has(kRecordedField)) continue;
    EXPECT_NE(settings_after(words_for(*command.get_option("--" + field.option))), usual) << field.option;
  }
}

}  // namespace
}  // namespace osteomill::app
