#pragma once

#include <atomic>
#include <deque>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "app/scan_options.h"
#include "app/simulate/histogram.h"
#include "app/simulate/simulation_settings.h"

#include "osteomill/live/live_session.h"
#include "osteomill/live/milled_copy.h"
#include "osteomill/operator/milling_entry.h"
#include "osteomill/operator/virtual_hand.h"
#include "osteomill/recording/recorder.h"
#include "osteomill/surface/live_surface.h"
#include "osteomill/view/cut_face.h"

namespace osteomill::app {

/// A bone that is being milled in real time by a virtual hand, and all that can be done to it; nothing of
/// windows. For one thread, except `open`. Whatever takes long (another algorithm, another tool, taking a cut
/// back) is prepared on a thread of its own: the tool goes on being felt meanwhile, but nothing is milled.
class Simulation {
 public:
  /// A scan made ready for milling.
  struct Opened {
    std::string scan_name;
    BoneDensities densities;
    MillingEntry entry;
    SimulationSettings settings;
    DensityHistogram histogram;
    GreyWindow grey_window;
    std::unique_ptr<LiveSurface> surface;
    std::unique_ptr<MillingSession> session;
  };
  /// Takes seconds; in any thread, also while another simulation goes on. Throws InputError as `load_bone`
  /// does, and std::invalid_argument for settings out of range.
  static Opened open(const ScanOptions& scan, const SimulationSettings& settings);
  /// Begins to tick; one simulation at a time.
  Simulation(Opened opened, const std::string& command_line);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Once a picture: takes in what the other threads did. Throws what a preparation failed with (the
  /// simulation goes on as it was).
  void update();

  VirtualHand& hand() { return hand_; }
  const MillingEntry& entry() const { return entry_; }
  void set_spindle(bool on);
  void set_paused(bool paused) { live_.set_paused(paused); }
  bool spindle_asked() const { return spindle_; }
  bool preparing() const { return preparation_.valid(); }
  /// Nothing where something is being prepared already.
  void change(const SimulationSettings& settings);
  void change_isovalue(double isovalue);
  void undo();
  void reset();
  std::size_t cuts() const { return copy_.cuts(); }
  bool touched() const { return copy_.touched(); }

  /// Throws InputError where the file cannot be written; a recording is then not going on.
  void start_recording(const std::filesystem::path& path);
  /// Returns the recording's name.
  std::filesystem::path stop_recording();
  bool recording() const { return recorder_ != nullptr; }
  /// A recording tells of one bone, one tool and one algorithm: where any of them changes it ends. Its name
  /// then, once.
  std::optional<std::filesystem::path> take_ended_recording() {
    return std::exchange(ended_recording_, std::nullopt);
  }

  const LiveState& state() { return live_.state(); }
  TimingSummary timing() const { return live_.timing(); }
  const std::string& refused_real_time() const { return live_.refused_real_time(); }
  /// The ticks of the last 5 seconds.
  const std::deque<TickRecord>& history() const { return history_; }

  const std::string& scan_name() const { return scan_name_; }
  const SimulationSettings& settings() const { return settings_; }
  const BoneDensities& densities() const { return densities_; }
  const DensityHistogram& histogram() const { return histogram_; }
  const GreyWindow& grey_window() const { return grey_window_; }
  double isovalue() const { return isovalue_; }
  /// The bone as last handed over: some ticks behind.
  const DensityGrid& bone() const { return copy_.grid(); }
  /// Grows with every change of `bone()`.
  std::uint64_t bone_version() const { return bone_version_; }
  LiveSurface& surface() { return *surface_; }
  /// Grows where `surface()` became another, to be taken from the beginning.
  int surface_number() const { return surface_number_; }

 private:
  // What another bone or algorithm takes.
  struct Prepared {
    std::unique_ptr<MillingSession> session;
    std::unique_ptr<LiveSurface> surface;
    SimulationSettings settings;
    double isovalue = 0;
  };
  // Between the haptic thread and this one, as long as anything listens.
  struct Outlet {
    explicit Outlet(const GridGeometry& geometry) : handover(geometry, 512) {}
    DensityHandover handover;
    std::atomic<std::size_t> waiting{0};
  };

  void listen();
  void take_changes();
  void hold_and_take_all();
  void take_history();
  void take_over(Prepared prepared);
  void rebuild(double removed_mm3);

  std::string scan_name_;
  std::string command_line_;
  BoneDensities densities_;
  MillingEntry entry_;
  SimulationSettings settings_;
  double isovalue_;
  MilledCopy copy_;
  DensityHistogram histogram_;
  GreyWindow grey_window_;
  std::uint64_t bone_version_ = 1;
  std::unique_ptr<LiveSurface> surface_;
  int surface_number_ = 1;
  Outlet outlet_;
  VirtualHand hand_;
  std::unique_ptr<Recorder> recorder_;
  std::filesystem::path recorder_path_;
  std::optional<std::filesystem::path> ended_recording_;
  LiveSession live_;
  std::future<Prepared> preparation_;
  std::deque<TickRecord> history_;
  bool spindle_ = false;
};

}  // namespace osteomill::app
