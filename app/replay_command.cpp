#include <memory>
#include <string>
#include <vector>

#include "app/commands.h"
#include "app/config_file.h"
#include "app/milling_options.h"
#include "app/progress.h"
#include "app/scan_options.h"
#include <fmt/core.h>

#include "osteomill/device/trajectory.h"
#include "osteomill/files/atomic_file.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/recording/write_csv.h"
#include "osteomill/session/fault_count.h"
#include "osteomill/session/label_count.h"
#include "osteomill/session/milling_setup.h"
#include "osteomill/session/replay.h"
#include "osteomill/volume/densities.h"

namespace osteomill::app {

namespace {

struct ReplayOptions {
  std::string trajectory;
  ScanOptions scan;
  MillingOptions milling;
  std::vector<AlgorithmDescription> algorithm{default_algorithm()};
  std::string out;
};

void run_replay(ReplayOptions options) {
  require_no_input(options.out, {options.trajectory, options.scan.scan});
  const std::vector<TrajectoryPoint> trajectory = read_trajectory(options.trajectory);
  LoadedBone bone = load_bone(options.scan);
  require_workable(options.milling.setup.tool, bone.volume.geometry());
  const BoneDensities densities = estimate_densities(bone.volume);
  options.milling.setup.algorithm = options.algorithm.front();
  const auto session =
      make_session(std::make_shared<Volume>(std::move(bone.volume)), densities, options.milling.setup);
  FaultCount faults;
  LabelCount labels;
  if (session->volume().labels()) labels = LabelCount(session->volume().labels()->labels());
  std::vector<TickRecord> log;
  log.reserve(trajectory.size());
  replay(*session, trajectory, [&](const TickRecord& record) {
    log.push_back(record);
    faults.add(record);
    if (const Label* touched = labels.add(record)) warn_of_no_go(no_go_warning(*touched, record));
    if (log.size() % 1000 == 0) {
      show_progress("replay", static_cast<double>(log.size()) / static_cast<double>(trajectory.size()));
    }
  });
  end_progress();
  if (const auto said = faults.sentence()) warn(options.trajectory + ": " + *said);
  write_csv(options.out, log);
  for (const std::string& line : label_lines(labels)) fmt::print("label {}\n", line);
  fmt::print("{}\n", options.out);
}

}  // namespace

void add_replay_command(CLI::App& program) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command =
      program.add_subcommand("replay", "Drive one algorithm along a trajectory and log every tick");
  command->group("Recordings");
  command->add_option("trajectory", options->trajectory, "CSV: time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling")
      ->required();
  add_scan_options(*command, options->scan);
  command->option_defaults()->group("The replay");
  add_algorithm_option(*command, options->algorithm);
  command->get_option("--algorithm")->expected(1);
  command->add_option("--out", options->out, "The log, CSV, a row a tick")->required()->type_name("FILE");
  add_mode_option(*command, options->milling.setup.haptics.mode);
  add_milling_options(*command, options->milling);
  add_quiet_option(*command);
  command->callback([=] {
    apply_config_file(*command);
    run_replay(*options);
  });
}

}  // namespace osteomill::app
