#include <memory>
#include <string>

#include "app/commands.h"
#include "app/config_file.h"
#include "app/milling_options.h"
#include "app/simulate/screen_scale.h"
#include "app/simulate/simulator.h"

namespace osteomill::app {

namespace {

struct SimulateOptions {
  SimulatorOptions simulator;
  MillingOptions milling;
  std::vector<AlgorithmDescription> algorithm{default_algorithm()};
};

void run_simulate(SimulateOptions options) {
  options.simulator.setup = options.milling.setup;
  options.simulator.setup.algorithm = options.algorithm.front();
  options.simulator.setup.vibration.on = true;
  run_simulator(options.simulator);
}

}  // namespace

void add_simulate_command(CLI::App& program, const std::string& command_line) {
  auto options = std::make_shared<SimulateOptions>();
  options->simulator.command_line = command_line;
  options->milling.setup.cutting_reaction = true;
  CLI::App* command =
      program.add_subcommand("simulate", "Open the window: see the bone, take the burr, mill");
  command->group("In a window");
  add_scan_options(*command, options->simulator.scan);
  command->option_defaults()->group("Algorithm");
  add_algorithm_option(*command, options->algorithm);
  command->get_option("--algorithm")->expected(1);
  add_milling_options(*command, options->milling);
  add_device_option(*command, options->simulator.device);
  add_send_options(*command, options->simulator.send);
  command->option_defaults()->group("The window");
  command->add_option("--out", options->simulator.folder, "For recordings and what is saved")
      ->type_name("FOLDER")
      ->capture_default_str();
  command
      ->add_option("--ui-scale", options->simulator.ui_scale,
                   "How much larger than usual text is (2 at 4K), else as the screen asks for")
      ->check(CLI::Range(kMinScale, kMaxScale));
  command->add_flag("--no-help", options->simulator.no_help,
                    "Begin without the page that explains the controls (else shown the first time)");
  command
      ->add_option("--script", options->simulator.script,
                   "Work the window from this file (app/simulate/ui_script.h)")
      ->type_name("FILE");
  command->callback([=] {
    apply_config_file(*command);
    run_simulate(*options);
  });
}

}  // namespace osteomill::app
