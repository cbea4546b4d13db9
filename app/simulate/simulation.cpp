#include "app/simulate/simulation.h"

#include <chrono>
#include <thread>
#include <utility>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/recording/describe_run.h"

namespace osteomill::app {

namespace {

using namespace std::chrono_literals;

constexpr std::size_t kHistory = 5000;
constexpr std::size_t kBricksPerTick = 8;

std::unique_ptr<MillingSession> make_session(std::shared_ptr<Volume> bone, const BoneDensities& densities,
                                             const SimulationSettings& settings) {
  auto session = std::make_unique<MillingSession>(std::move(bone), settings.tool,
                                                  make_algorithm(settings.algorithm, settings.haptics),
                                                  densities, milling_settings(settings), settings.limits);
  VibrationSettings vibration;
  vibration.on = settings.vibration;
  vibration.spindle_speed_rpm = settings.cutting.spindle_speed_rpm;
  session->set_vibration(vibration);
  return session;
}

HandleSettings handle_settings(const SimulationSettings& settings) {
  HandleSettings handle;
  handle.limits = settings.limits;
  return handle;
}

}  // namespace

Simulation::Opened Simulation::open(const ScanOptions& scan, const SimulationSettings& settings) {
  LoadedBone loaded = load_bone(scan);
  const auto bone = std::make_shared<Volume>(std::move(loaded.volume));
  const BoneDensities densities = estimate_densities(*bone);
  return {loaded.name,
          densities,
          place_entry(*bone, settings.tool),
          settings,
          histogram_of(bone->grid()),
          grey_window_of(bone->grid(), densities.surroundings),
          std::make_unique<LiveSurface>(*bone),
          make_session(bone, densities, settings)};
}

Simulation::Simulation(Opened opened, const std::string& command_line)
    : scan_name_(std::move(opened.scan_name)),
      command_line_(command_line),
      densities_(opened.densities),
      entry_(opened.entry),
      settings_(opened.settings),
      isovalue_(opened.session->volume().isovalue()),
      copy_(opened.session->volume().grid()),
      histogram_(opened.histogram),
      grey_window_(opened.grey_window),
      surface_(std::move(opened.surface)),
      outlet_(opened.session->volume().geometry()),
      hand_(handle_settings(settings_), pointing_hand(), pose_above(entry_, settings_.tool, kStartAbove_mm)),
      live_(std::move(opened.session), hand_) {
  listen();
  live_.start();
}

Simulation::~Simulation() {
  if (preparation_.valid()) preparation_.wait();
  live_.stop();
}

void Simulation::listen() {
  live_.wait_for(
      live_.listen([surface = surface_.get(), outlet = &outlet_, recorder = recorder_.get()](
                       const TickRecord& record, const Volume& volume, const VolumeChange& change) {
        surface->volume_changed(volume, change);
        outlet->handover.mark(change);
        outlet->handover.send(volume, kBricksPerTick);
        outlet->waiting.store(outlet->handover.waiting(), std::memory_order_release);
        if (recorder != nullptr) recorder->push(record);
      }));
}

void Simulation::update() {
  take_changes();
  take_history();
  if (!preparing() || preparation_.wait_for(0s) != std::future_status::ready) return;
  try {
    take_over(preparation_.get());
  } catch (...) {
    live_.hold_bone(false);
    throw;
  }
}

void Simulation::take_changes() {
  bool changed = false;
  while (const DensityHandover::Brick* brick = outlet_.handover.front()) {
    changed = copy_.put(*brick) || changed;
    outlet_.handover.pop();
  }
  if (changed) ++bone_version_;
}

// So that the copy is the bone, and the bone stays as it is until it is released.
void Simulation::hold_and_take_all() {
  live_.wait_for(live_.hold_bone(true));
  // A tick later nothing new is marked.
  do {
    take_changes();
    std::this_thread::sleep_for(2ms);
  } while (outlet_.waiting.load(std::memory_order_acquire) > 0 && live_.running());
  take_changes();
}

void Simulation::take_history() {
  while (const auto record = live_.next_record()) history_.push_back(*record);
  while (history_.size() > kHistory) history_.pop_front();
}

void Simulation::set_spindle(bool on) {
  if (on && !spindle_) copy_.begin_cut(live_.state().record.removed_mm3);
  spindle_ = on;
  live_.set_spindle(on);
}

void Simulation::change(const SimulationSettings& settings) {
  if (preparing()) return;
  live_.wait_for(live_.hold_bone(true));
  preparation_ =
      std::async(std::launch::async, [this, settings, bone = live_.session().shared_volume(),
                                      isovalue = isovalue_, removed_mm3 = live_.session().removed_mm3()] {
        Prepared prepared{make_session(bone, densities_, settings), nullptr, settings, isovalue};
        prepared.session->count_removed_from(removed_mm3);
        return prepared;
      });
}

void Simulation::change_isovalue(double isovalue) {
  if (preparing()) return;
  hold_and_take_all();
  isovalue_ = isovalue;
  rebuild(live_.session().removed_mm3());
}

void Simulation::undo() {
  if (preparing()) return;
  hold_and_take_all();
  rebuild(copy_.undo());
}

void Simulation::reset() {
  if (preparing()) return;
  hold_and_take_all();
  copy_.reset();
  rebuild(0);
}

// A bone from the copy, which stays as it is while the bone is held.
void Simulation::rebuild(double removed_mm3) {
  ++bone_version_;
  preparation_ =
      std::async(std::launch::async, [this, settings = settings_, isovalue = isovalue_, removed_mm3] {
        auto bone = std::make_shared<Volume>(copy_.grid(), isovalue);
        auto surface = std::make_unique<LiveSurface>(*bone);
        Prepared prepared{make_session(bone, densities_, settings), std::move(surface), settings, isovalue};
        prepared.session->count_removed_from(removed_mm3);
        return prepared;
      });
}

void Simulation::take_over(Prepared prepared) {
  if (recording()) ended_recording_ = stop_recording();
  settings_ = prepared.settings;
  live_.wait_for(live_.replace({std::move(prepared.session), {}}));
  if (prepared.surface) {
    const std::unique_ptr<LiveSurface> before = std::exchange(surface_, std::move(prepared.surface));
    ++surface_number_;
    listen();
  }
  live_.hold_bone(false);
}

void Simulation::start_recording(const std::filesystem::path& path) {
  const RunFacts facts{
      scan_name_,        bone().geometry(),           isovalue_,        densities_, settings_.tool,
      settings_.haptics, milling_settings(settings_), settings_.limits, 0,          1e-3,
      command_line_};
  const int points = live_.session().algorithm().sample_point_count();
  RunDescription run = describe_run(facts, settings_.algorithm, points);
  run.settings.push_back({"vibration", settings_.vibration ? 1.0 : 0.0, ""});
  recorder_ = std::make_unique<Recorder>(path, run);
  recorder_path_ = path;
  listen();
}

std::filesystem::path Simulation::stop_recording() {
  const std::unique_ptr<Recorder> recorder = std::move(recorder_);
  listen();
  recorder->close();
  return recorder_path_;
}

}  // namespace osteomill::app
