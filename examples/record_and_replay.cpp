// Records a session of your own and replays it: a device with poses set by the program presses on the
// built-in tooth and mills it.

#include <cstdio>
#include <memory>

#include <osteomill/recording/recorder.h>
#include <osteomill/recording/recording.h>
#include <osteomill/recording/replay_recording.h>
#include <osteomill/recording/run_description.h>
#include <osteomill/session/milling_entry.h>
#include <osteomill/session/trajectory.h>
#include <osteomill/volume/builtin_tooth.h>
#include <osteomill/volume/density_grid.h>

int main(int argc, char** argv) {
  const char* path = argc > 1 ? argv[1] : "session.h5";
  const osteomill::Volume scan(osteomill::builtin_tooth(), osteomill::kBuiltinToothIsovalue);
  const osteomill::BoneDensities densities = estimate_densities(scan);
  osteomill::MillingSetup setup;
  setup.algorithm = osteomill::algorithm_named("point-shell");
  osteomill::MillingSession session(std::make_shared<osteomill::Volume>(scan), densities, setup);

  const osteomill::ScanIdentity identity{"built-in tooth", fingerprint_of(scan.grid())};
  const osteomill::RunDescription run =
      describe_run(scan, identity, {setup, densities}, session.algorithm().sample_point_count());
  osteomill::Recorder recorder(path, run);
  const osteomill::MillingEntry entry = place_entry(scan, setup.tool);
  osteomill::PosedDevice device;
  for (int n = 0; n < 2000; ++n) {
    device.put(pose_above(entry, setup.tool, 0.5 - 0.001 * n));
    recorder.push_waiting(session.tick(device, {.time_s = 1e-3 * n, .spindle_on = n > 500}));
  }
  recorder.close();

  const osteomill::Verification verified = verify_recording(scan, osteomill::read_recording(path));
  std::printf("%.2f mm^3 removed; %zu ticks the same\n", session.removed_mm3(), verified.ticks);
  if (verified.difference) std::printf("%s\n", verified.difference->what.c_str());
  return verified.difference || !(session.removed_mm3() > 0) ? 1 : 0;
}
