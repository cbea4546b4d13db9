#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/session/milling_setup.h"

#include "app/branch_options.h"
#include "app/exercise_options.h"
#include "app/scan_options.h"
#include "app/simulate/autosave.h"
#include "app/simulate/simulation.h"

namespace osteomill::app {

/// Request to open a scan for milling, a recording (in place of a scan) for playback, an exercise on its
/// scan, or a recording to continue from one of its ticks.
struct OpenRequest {
  ScanOptions scan;
  ExerciseOptions exercise = {};
  BranchOptions from = {};
  /// Milled bone of an earlier run of the program.
  std::optional<LeftoverMilling> milled = {};

  /// Returns the file or folder to open, or the name of the built-in tooth.
  std::string name() const;
};

/// Opens the requested object. For a folder with several series, unless one is named or milled, returns only
/// their list (`PreparedScan::series`). An exercise selects the one of its burrs nearest to the setup's.
/// Takes seconds; any thread, also while another scan is milled. Throws InputError as `load_bone`,
/// `load_exercise`, `open_branch`, `load_recording` and Playback do, and if `milled` belongs to another
/// scan; std::invalid_argument for settings out of range.
PreparedScan open_requested(const OpenRequest& request, MillingSetup setup);

/// Opens on a thread of its own and can be stopped: that thread then ends within about 0.1 s and frees its
/// memory. Only the destructor waits for it. For one thread.
class Opening {
 public:
  Opening() = default;
  ~Opening() { stop(); }
  Opening(const Opening&) = delete;
  Opening& operator=(const Opening&) = delete;

  /// Stops opening, if in progress, and starts opening something else.
  void begin(OpenRequest request, const MillingSetup& setup);
  void stop();

  /// Returns whether something is being opened, or is ready and not yet taken.
  bool is_begun() const { return result_.valid(); }
  bool is_ready() const;
  /// Returns the opened object once it is ready, or throws the exception of opening it; clears the request.
  PreparedScan take();
  /// Returns the current request. Only while `is_begun`.
  const OpenRequest& request() const { return *request_; }
  /// Returns the progress of opening, 0 to 1.
  double share_done() const { return work_ ? work_->share_done.load() : 0; }
  /// Returns the time since `begin`, s.
  double passed_s() const;

 private:
  struct Work {
    std::atomic<double> share_done = 0;
    std::atomic<bool> stopped = false;
  };
  std::shared_ptr<const OpenRequest> request_;
  std::chrono::steady_clock::time_point since_;
  std::shared_ptr<Work> work_;
  std::future<PreparedScan> result_;
  std::vector<std::future<PreparedScan>> stopped_;
};

}  // namespace osteomill::app
