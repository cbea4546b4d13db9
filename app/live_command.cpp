#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "app/commands.h"
#include "app/config_file.h"
#include "app/positive_number.h"
#include "app/progress.h"
#include "app/scan_options.h"
#include "app/trial_options.h"
#include <fmt/core.h>

#include "osteomill/experiment/paper.h"
#include "osteomill/experiment/trial_plan.h"
#include "osteomill/live/live_session.h"
#include "osteomill/recording/recorder.h"
#include "osteomill/surface/live_surface.h"

namespace osteomill::app {

namespace {

struct LiveOptions {
  ScanOptions scan;
  TrialOptions trial;
  std::vector<AlgorithmDescription> algorithm{algorithm_named("point-shell")};
  double seconds = 60;
  std::string record;
};

void print_times(const char* what, const TimePercentiles& times) {
  fmt::print("{:<12} p50 {:6.0f}   p99 {:6.0f}   p99.9 {:6.0f}   greatest {:6.0f} us\n", what, times.p50_us,
             times.p99_us, times.p999_us, times.greatest_us);
}

void print_timing(const TimingSummary& timing) {
  fmt::print("rate         {:.1f} Hz over {} ticks\n", timing.rate_hz, timing.ticks);
  print_times("lateness", timing.lateness);
  fmt::print("late ticks   {} by over 1 ms ({:.3f} %), {} missed\n", timing.late_ticks,
             100.0 * static_cast<double>(timing.late_ticks) / static_cast<double>(timing.ticks),
             timing.missed_ticks);
  print_times("step", timing.step);
  print_times("milling", timing.milling);
  print_times("whole tick", timing.tick);
}

// Takes the surface as a window would; returns how many bricks were meshed while milling.
std::size_t run_for(LiveSession& live, LiveSurface& surface, double seconds) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  double passed_s = 0;
  std::size_t bricks = 0;
  while (passed_s < seconds && live.running()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    passed_s = std::chrono::duration<double>(Clock::now() - start).count();
    bricks += surface.take_changed_bricks().size();
    show_progress("live", passed_s / seconds);
  }
  live.stop();
  end_progress();
  return bricks;
}

void run_live(LiveOptions options, const std::string& command_line) {
  ScriptSettings& script = options.trial.hand.script;
  script.milling_s = script.holding_s = 0.5 * options.seconds;
  const AlgorithmDescription& algorithm = options.algorithm.front();
  const LoadedBone bone = load_bone(options.scan);
  const TrialPlan plan{bone.volume,
                       bone.name,
                       estimate_densities(bone.volume),
                       place_entry(bone.volume, options.trial),
                       trial_settings(options.trial),
                       command_line};
  SimulatedOperator hand(plan.settings.hand_and_device, plan.settings.tool, plan.entry);
  auto session = std::make_unique<MillingSession>(
      bone.volume, plan.settings.tool, make_algorithm(algorithm, plan.settings.haptics), plan.densities,
      plan.settings.milling, plan.settings.limits);
  std::optional<Recorder> recorder;
  if (!options.record.empty()) {
    recorder.emplace(options.record,
                     describe_trial(plan, algorithm, session->algorithm().sample_point_count(), kMilling));
  }
  LiveSurface surface(bone.volume);
  FaultCount faults;
  LiveSession live(std::move(session), hand, plan.settings.tick_s);
  live.listen([&](const TickRecord& record, const Volume& volume, const VolumeChange& change) {
    faults.add(record);
    surface.volume_changed(volume, change);
    if (recorder) recorder->push(record);
  });
  live.start();
  if (!live.refused_real_time().empty()) fmt::print(stderr, "osteomill: {}\n", live.refused_real_time());
  const std::size_t bricks = run_for(live, surface, options.seconds);
  if (recorder) recorder->close();
  print_faults(algorithm.id.name, faults);
  print_timing(live.timing());
  fmt::print("removed      {:.2f} mm^3, {} bricks of the surface meshed\n", live.state().record.removed_mm3,
             bricks);
}

}  // namespace

void add_live_command(CLI::App& program, const std::string& command_line) {
  auto options = std::make_shared<LiveOptions>();
  CLI::App* command = program.add_subcommand(
      "live", "Run one algorithm in real time with the simulated hand, and say how well time is kept");
  add_scan_options(*command, options->scan);
  add_algorithm_option(*command, options->algorithm);
  command->get_option("--algorithm")->expected(1);
  add_trial_options(*command, options->trial);
  command->remove_option(command->get_option("--seconds"));
  add_positive(*command, "--seconds", options->seconds, "s, half of it milling, half holding still");
  command->add_option("--record", options->record, "A recording (HDF5) of every tick");
  command->callback([=] {
    apply_config_file(*command);
    run_live(*options, command_line);
  });
}

}  // namespace osteomill::app
