#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "osteomill/base/file_lock.h"
#include "osteomill/study/measure_rates.h"
#include "osteomill/study/write_rates_report.h"

#include "app/commands.h"
#include "app/config_file.h"
#include "app/milling_options.h"
#include "app/progress.h"
#include "app/scan_options.h"
#include "app/trial_options.h"

namespace osteomill::app {

namespace {

struct RatesOptions {
  ScanOptions scan;
  TrialOptions trial;
  std::vector<AlgorithmDescription> algorithms = all_algorithms();
  std::string out = "osteomill-rates";
};

void run_rates(const RatesOptions& options) {
  const OutputFolder folder(options.out);
  const LoadedBone bone = load_bone(options.scan);
  TrialPlan plan = trial_plan(bone, options.trial, "");
  for (const AlgorithmDescription& algorithm : options.algorithms) {
    plan.settings.algorithm = algorithm;
    warn_of_settings(plan.settings, bone.volume.geometry());
  }
  MeasuredRates measured{measure_rates(plan, options.algorithms, show_progress), {}};
  end_progress();
  const bool has_vertices = std::any_of(options.algorithms.begin(), options.algorithms.end(),
                                        [](const auto& one) { return one.id == "surface-points"; });
  if (has_vertices) measured.vertices = search_vertices();
  fmt::print("{}\n", write_rates_report(measured, options.out).string());
}

}  // namespace

void add_rates_command(CLI::App& program) {
  auto options = std::make_shared<RatesOptions>();
  options->trial.hand.script.milling_s = options->trial.hand.script.holding_s = 2.0;
  CLI::App* command = program.add_subcommand(
      "rates", "Measure each algorithm's update rate against its resolution (section 8.1 of the paper)");
  add_scan_options(*command, options->scan);
  command->group("Compare and measure");
  command->option_defaults()->group("The measurement");
  command->add_option("--out", options->out, "Folder for the report, its tables and figure")
      ->type_name("FOLDER")
      ->capture_default_str();
  add_algorithm_option(*command, options->algorithms);
  add_trial_options(*command, options->trial);
  add_quiet_option(*command);
  command->callback([=] {
    apply_config_file(*command);
    apply_implied_law(*command, options->trial.milling.setup);
    run_rates(*options);
  });
}

}  // namespace osteomill::app
