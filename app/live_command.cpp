#include <chrono>
#include <cstdlib>
#include <exception>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include <CLI/Error.hpp>
#include <fmt/core.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/work_progress.h"
#include "osteomill/live/live_milling.h"
#include "osteomill/openigtlink/bone_sender.h"
#include "osteomill/session/milling_setup.h"
#include "osteomill/session/space_mouse.h"
#include "osteomill/session/tick_counts.h"
#include "osteomill/session/virtual_hand.h"
#include "osteomill/study/entry_pictures.h"

#include "app/branch_options.h"
#include "app/commands.h"
#include "app/config_file.h"
#include "app/device_option.h"
#include "app/exercise_options.h"
#include "app/option_checks.h"
#include "app/progress.h"
#include "app/scan_options.h"
#include "app/trial_options.h"

namespace osteomill::app {

namespace {

constexpr double kUpdatePeriod_s = 0.02;

struct LiveOptions {
  ScanOptions scan;
  ExerciseOptions exercise;
  BranchOptions from;
  TrialOptions trial;
  double seconds = 60;
  std::string record;
  DeviceOption device{kSimulated};
  bool spindle = false;
  SendOption send;
};

void print_times(const char* what, const TimePercentiles& times) {
  fmt::print("{:<12} p50 {:6.0f}   p99 {:6.0f}   p99.9 {:6.0f}   max {:6.0f} us\n", what, times.p50_us,
             times.p99_us, times.p999_us, times.max_us);
}

void print_timing(const TimingSummary& timing) {
  fmt::print("rate         {:.1f} Hz sustainable at these tick times; {:.1f} Hz measured over {} ticks\n",
             timing.rate_hz, timing.ticks_per_s, timing.ticks);
  print_times("lateness", timing.lateness);
  fmt::print("late ticks   {} by over 1 ms ({:.3f} %), {} missed\n", timing.late_ticks,
             100.0 * static_cast<double>(timing.late_ticks) / static_cast<double>(timing.ticks),
             timing.missed_ticks);
  print_times("step", timing.step);
  print_times("milling", timing.milling);
  print_times("whole tick", timing.tick);
}

// Totals over all ticks, printed at the end.
struct LiveFigures {
  LabelCount labels;
  FaultCount faults = {};
  std::size_t bricks = 0;
  bool has_recording_failed = false;
};

// A full disk ends the recording, not the session.
void end_recording(LiveMilling& milling, LiveFigures& figures) {
  try {
    milling.stop_recording();
  } catch (const InputError& error) {
    warn_despite_quiet(error.what());
    figures.has_recording_failed = true;
  }
}

// The source of the tool's motion: hardware, a SpaceMouse or the simulated operator.
class LiveToolSource {
 public:
  explicit LiveToolSource(const DeviceOption& option) : option_(option), hardware_(open_device(option)) {
    if (option.is_device(kMouse)) throw InputError("--device mouse", "needs the window: osteomill simulate");
    if (option.is_device(kSpaceMouse)) space_mouse_.emplace();
  }

  const ConnectedDevice* hardware() const { return hardware_.get(); }
  // Places the tool in front of the entry, and applies the hardware's limits to the setup.
  Device& place_tool(const TrialOptions& trial, MillingSetup& setup, const MillingEntry& entry) {
    const Pose X_WT = pose_above(entry, setup.tool, kStartHeight_mm);
    if (hardware_) {
      setup.guard.limits = hardware_->limits_W(setup.guard.limits);
      hardware_->put_at(X_WT);
      return *hardware_;
    }
    const OperatorSettings simulated = trial_settings(trial).hand_and_device;
    if (!space_mouse_) return simulated_.emplace(simulated, setup.tool, entry);
    X_W_target_ = X_WT;
    return virtual_.emplace(simulated.handle, pointing_hand(), X_WT);
  }

  void update(double passed_s) {
    if (hardware_) warn_of(hardware_->report());
    if (!space_mouse_) return;
    X_W_target_ = moved(X_W_target_, space_mouse_->read(), view_from_the_front(), passed_s);
    virtual_->pull_to(X_W_target_);
  }

  // Warns if the vendor's software does not stop.
  void close() {
    if (!hardware_) return;
    if (const std::string message = hardware_->close(); !message.empty())
      warn_despite_quiet(hardware_->capabilities().name + ": " + message);
  }

  void print() const {
    if (!hardware_) return;
    const DeviceReport report = hardware_->report();
    fmt::print("device       {}: {:.0f} poses/s, {} faults, reopened {} times, {} late wrenches\n",
               hardware_->capabilities().name, report.inputs_per_s, report.faults, report.reopened,
               report.late_wrenches);
  }
  void describe(RunDescription& run) const { describe_device(run, option_.device, hardware_.get()); }

 private:
  static constexpr double kStartHeight_mm = 1;

  // Warns once when a fault persists, and once when it is over; shorter faults are only counted.
  void warn_of(const DeviceReport& report) {
    constexpr double kLasting_s = 0.1;
    const bool well = report.state == DeviceReport::State::ok;
    if ((report.state == state_ && report.reason == reason_) || (!well && report.since_s < kLasting_s))
      return;
    state_ = report.state;
    reason_ = report.reason;
    warn(hardware_->capabilities().name + (well ? ": works again" : ": " + report.complaint()));
  }

  DeviceOption option_;
  std::unique_ptr<ConnectedDevice> hardware_;
  DeviceReport::State state_ = DeviceReport::State::ok;
  std::string reason_;
  std::optional<SpaceMouse> space_mouse_;
  std::optional<SimulatedOperator> simulated_;
  std::optional<VirtualHand> virtual_;
  Pose X_W_target_;
};

LiveFigures run_for(LiveMilling& milling, double seconds, const std::shared_ptr<const LabelMap>& labels,
                    LiveToolSource& tool_source, BoneSender* sender) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  double passed_s = 0;
  LiveFigures figures{.labels = LabelCount(labels)};
  const auto take = [&] {
    while (const auto record = milling.next_record()) {
      figures.faults.add(*record);
      if (const auto touched = figures.labels.add(*record)) warn_despite_quiet(*touched);
    }
    figures.bricks += milling.take_changed_bricks().size();
    if (milling.has_recording_failed()) end_recording(milling, figures);
  };
  while (passed_s < seconds && milling.is_running()) {
    std::this_thread::sleep_for(std::chrono::duration<double>(kUpdatePeriod_s));
    passed_s = std::chrono::duration<double>(Clock::now() - start).count();
    take();
    tool_source.update(kUpdatePeriod_s);
    if (sender != nullptr) sender->show_tool(milling.state().record);
    show_progress("live", passed_s / seconds);
  }
  milling.stop();
  take();
  end_progress();
  return figures;
}

// Resumes the recording of --from, if given, and replaces the setup by the recorded one, except for the
// guard.
std::optional<Branch> take_branch(LiveOptions& options) {
  if (!options.from.given()) return std::nullopt;
  const WorkProgress progress([](double share) { show_progress("resume", share); });
  Branch branch = open_branch(options.from, options.scan, options.exercise);
  end_progress();
  MillingSetup& setup = options.trial.milling.setup;
  const GuardSettings guard = setup.guard;
  setup = branch.resumed.session->setup();
  setup.guard = guard;
  return branch;
}

BoneToMill to_mill(LoadedRecording& work) {
  std::optional<Vec3> entry_W_mm;
  if (work.placed) entry_W_mm = work.placed->exercise.entry_W_mm;
  return {std::move(work.bone), work.scan, work.exercise, entry_W_mm};
}

void run_live(LiveOptions options, const std::string& command_line) {
  ScriptSettings& script = options.trial.hand.script;
  script.milling_s = script.holding_s = 0.5 * options.seconds;
  LiveToolSource tool_source(options.device);
  MillingSetup& setup = options.trial.milling.setup;
  std::optional<Branch> branch = take_branch(options);
  auto [loaded, scan, exercise, entry_W_mm] =
      branch ? to_mill(branch->work) : load_bone_to_mill(options.exercise, options.scan, setup);
  if (!options.trial.entry_W_mm) options.trial.entry_W_mm = entry_W_mm;
  warn_of_settings(setup, loaded.volume.geometry());
  const auto bone = std::make_shared<Volume>(std::move(loaded.volume));
  const std::shared_ptr<const LabelMap> labels = bone->labels();
  const MillingEntry entry = place_entry(*bone, loaded.name, options.trial);
  Device& device = tool_source.place_tool(options.trial, setup, entry);
  PreparedMilling prepared =
      branch ? prepare_milling(bone, branch->resumed, setup.guard) : prepare_milling(bone, setup);
  const BoneDensities densities = prepared.session->densities();
  LiveMilling milling(std::move(prepared), device);
  if (options.spindle) milling.set_spindle(true);
  const std::unique_ptr<BoneSender> sender = send_bone(milling.follower(), options.send);
  std::optional<EntryPictures> pictures;
  if (!options.record.empty()) {
    pictures.emplace(*bone, densities.reference, entry, events_on_terminal(), !is_builtin(scan.scan));
    RunDescription run = milling.describe(loaded.name, command_line);
    std::ranges::move(scan_settings(scan), std::back_inserter(run.settings));
    tool_source.describe(run);
    if (exercise) put_exercise(run, *exercise);
    if (branch) put_branch_point(run, branch->from);
    const auto picture = [&](std::string_view name) {
      std::optional<std::vector<unsigned char>> png;
      milling.follower().read(
          [&](const Volume& now) { png = pictures->of(name, now, events_on_terminal()); });
      return png;
    };
    if (const std::string kept = milling.start_recording(options.record, run, picture); !kept.empty())
      warn_despite_quiet(kept);
  }
  milling.start();
  if (!milling.refused_real_time().empty()) warn(milling.refused_real_time());
  LiveFigures figures = run_for(milling, options.seconds, labels, tool_source, sender.get());
  if (milling.is_recording()) end_recording(milling, figures);
  if (sender && !sender->is_connected())
    warn("--send-bone " + options.send.address + ": the receiver has gone");
  if (const auto message = figures.faults.sentence()) warn(setup.algorithm.id.name + ": " + *message);
  print_timing(milling.timing());
  fmt::print("removed      {:.2f} mm³, {} surface bricks meshed\n", milling.state().record.removed_mm3,
             figures.bricks);
  tool_source.print();
  tool_source.close();
  for (const std::string& line : label_lines(figures.labels)) fmt::print("label        {}\n", line);
  if (const std::exception_ptr failure = milling.failure())
    throw InputError("--device " + options.device.device, "has failed: " + reason_of(failure));
  if (figures.has_recording_failed) throw CLI::RuntimeError(EXIT_FAILURE);
}

}  // namespace

void add_live_command(CLI::App& program, const std::string& command_line) {
  auto options = std::make_shared<LiveOptions>();
  options->trial.milling.setup.law = CuttingLaw::chips;
  CLI::App* command = program.add_subcommand(
      "live", "Run one algorithm in real time with a device or the simulated hand, and print its timing");
  command->group("Compare and measure");
  add_scan_options(*command, options->scan);
  add_exercise_options(*command, options->exercise);
  add_branch_options(*command, options->from);
  add_algorithm_option(*command, options->trial.milling.setup.algorithm);
  add_trial_options(*command, options->trial);
  command->remove_option(command->get_option("--seconds"));
  command->option_defaults()->group("The hand and its device");
  add_positive(
      *command, "--seconds", options->seconds, "s",
      "Length of the session; the simulated hand mills in the first half and holds still in the second");
  add_rate_option(*command, options->trial.milling.setup.tick_s);
  command->add_option("--record", options->record, "Recording (HDF5) to write, with every tick")
      ->type_name("FILE");
  add_device_option(*command, options->device);
  command->add_flag("--spindle", options->spindle,
                    "Switch the spindle on at the start, without the device's button");
  add_send_options(*command, options->send);
  add_quiet_option(*command);
  command->callback([=] {
    apply_config_file(*command);
    apply_implied_law(*command, options->trial.milling.setup);
    if (options->from.given()) refuse_recorded_options(*command);
    run_live(*options, command_line);
  });
}

}  // namespace osteomill::app
