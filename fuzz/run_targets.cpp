#include "app/config_file.h"
#include "app/milling_options.h"
#include "fuzz/targets.h"
#include <CLI/CLI.hpp>

#include "osteomill/device/trajectory.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/recording/read_recording.h"
#include "osteomill/recording/recording_file.h"

namespace osteomill::fuzzing {

namespace fs = std::filesystem;

namespace {

void read_trajectory_of(Bytes bytes, const fs::path& folder) {
  write_bytes(folder / "poses.csv", bytes);
  read_trajectory(folder / "poses.csv");
}

std::vector<std::string> trajectory_seeds(const fs::path&) {
  return {"time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling\n0,0,0,30,1,0,0,0,0\n0.001,0,0,30,1,0,0,0,1\n",
          "# a comment\nmilling,time_s,qw,qx,qy,qz,x_mm,y_mm,z_mm,other\n1,0.5,0,1,0,0,1e-3,-2,3,text\n"};
}

void read_config(Bytes bytes, const fs::path& folder) {
  write_bytes(folder / "c.toml", bytes);
  CLI::App program;
  CLI::App* const command = program.add_subcommand("replay", "");
  app::MillingOptions milling;
  bool flag = false;
  double number = 0;
  std::string text;
  command->add_flag("--quiet", flag);
  command->add_option("--seconds", number);
  command->add_option("--out", text);
  app::add_milling_options(*command, milling);
  program.parse(std::vector<std::string>{(folder / "c.toml").string(), "--config", "replay"});
  app::apply_config_file(*command);
}

std::vector<std::string> config_seeds(const fs::path&) {
  return {
      "quiet = true\nseconds = 1.5\nout = \"x\"\nburr-radius = 2\n[point-shell]\nguarded-move = true\nscale "
      "= 2\n",
      "seconds = [1, 2]\nout = '''a\nb'''\nset = ['point-shell.scale=2']\n[a.b.c]\nd = {e = 1979-05-27}\n"};
}

void read_recording_of(Bytes bytes, const fs::path& folder) {
  write_bytes(folder / "a.h5", bytes);
  read_recording(folder / "a.h5");
}

// One that is not finished, since the checksum would refuse whatever is changed in one that is.
std::vector<std::string> recording_seeds(const fs::path& folder) {
  RunDescription description;
  description.scan_name = "made up";
  description.algorithm = algorithm_named("point-shell").id;
  {
    RecordingFile file(folder / "a.h5", description);
    file.append(std::vector<TickRecord>(3));
    file.flush(0);
  }
  return {read_bytes(folder / "a.h5")};
}

}  // namespace

std::vector<Target> run_targets() {
  return {{"trajectory", read_trajectory_of, trajectory_seeds},
          {"config", read_config, config_seeds},
          {"recording", read_recording_of, recording_seeds}};
}

}  // namespace osteomill::fuzzing
