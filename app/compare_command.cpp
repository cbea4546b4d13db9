#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/commands.h"
#include "app/config_file.h"
#include "app/record_trial.h"
#include "app/scan_options.h"
#include "app/trial_options.h"
#include <fmt/core.h>

#include "osteomill/files/atomic_file.h"
#include "osteomill/recording/read_recording.h"
#include "osteomill/report/write_report.h"

namespace osteomill::app {

namespace fs = std::filesystem;

namespace {

struct CompareOptions {
  ScanOptions scan;
  TrialOptions trial;
  std::vector<AlgorithmId> algorithms{kAllAlgorithms.begin(), kAllAlgorithms.end()};
  std::string out = "osteomill-comparison";
};

void run_compare(const CompareOptions& options, const std::string& command_line) {
  const LoadedBone bone = load_bone(options.scan);
  const TrialPlan plan{bone, estimate_densities(bone.volume), place_entry(bone.volume, options.trial),
                       trial_settings(options.trial), command_line};
  create_folder(options.out);
  std::vector<Recording> recordings;
  for (const AlgorithmId algorithm : options.algorithms) {
    for (const fs::path& path : record_trial(plan, algorithm, options.out)) {
      recordings.push_back(read_recording(path));
    }
  }
  fmt::print("{}\n", write_report(recordings, options.out).string());
}

}  // namespace

void add_compare_command(CLI::App& program, const std::string& command_line) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command = program.add_subcommand(
      "compare", "Mill with each algorithm in a simulated hand (section 8.2 of the paper) and report");
  add_scan_options(*command, options->scan);
  command->add_option("--out", options->out, "Folder for the report and the recordings")
      ->capture_default_str();
  add_algorithm_option(*command, options->algorithms);
  add_trial_options(*command, options->trial);
  command->callback([=] {
    apply_config_file(*command);
    run_compare(*options, command_line);
  });
}

}  // namespace osteomill::app
