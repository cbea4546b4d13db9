#include <memory>
#include <string>

#include "osteomill/recording/recording.h"

#include "app/commands.h"
#include "app/config_file.h"
#include "app/option_checks.h"
#include "app/simulate/screen_scale.h"
#include "app/simulate/simulator.h"

namespace osteomill::app {

void add_simulate_command(CLI::App& program, const std::string& command_line, WindowDriver* driver) {
  auto options = std::make_shared<SimulatorOptions>();
  options->driver = driver;
  options->command_line = command_line;
  options->milling.setup.cutting_reaction = options->milling.setup.drag = true;
  options->milling.setup.vibration.on = true;
  options->milling.setup.law = CuttingLaw::chips;
  CLI::App* command = program.add_subcommand(
      "simulate", "Open a window to mill a bone, or to play back a recording given in place of the scan");
  command->group("In a window");
  add_scan_options(*command, options->scan, "the start page, from which to choose");
  add_exercise_options(*command, options->exercise);
  add_guidance_option(*command, options->exercise);
  add_branch_options(*command, options->from);
  // With a recording in place of the scan, --at sets the start of playback.
  CLI::Option* const at = command->get_option("--at");
  at->remove_needs(command->get_option("--from"));
  command->option_defaults()->group("Algorithm");
  add_algorithm_option(*command, options->milling.setup.algorithm);
  add_milling_options(*command, options->milling);
  add_device_option(*command, options->device);
  add_rate_option(*command, options->milling.setup.tick_s);
  add_send_options(*command, options->send);
  command->option_defaults()->group("The window");
  command->add_option("--out", options->folder, "Folder for recordings and saved files")
      ->type_name("FOLDER")
      ->capture_default_str();
  command
      ->add_option("--ui-scale", options->ui_scale,
                   "Scale of the text; 1 is normal, 2 suits 4K screens (default: follows the screen)")
      ->check(number_of({.min = kMinScale, .max = kMaxScale}))
      ->type_name("NUMBER");
  command->add_flag("--no-help", options->no_help,
                    "Start without the help page (default: shown on the first start)");
  command->callback([=] {
    apply_config_file(*command);
    apply_implied_law(*command, options->milling.setup);
    if (options->from.given()) refuse_recorded_options(*command);
    if (at->count() > 0 && !options->from.given() && !is_hdf5(options->scan.scan))
      throw CLI::RequiredError("--at: --from, or a recording to be played,");
    options->remembered = read_preferences();
    options->is_tool_free = given_tool_options(*command).empty();
    Simulator(*options).run();
  });
}

}  // namespace osteomill::app
