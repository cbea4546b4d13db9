#pragma once

#include <chrono>
#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "osteomill/live/live_milling.h"
#include "osteomill/session/simulated_operator.h"
#include "osteomill/session/tick_counts.h"
#include "osteomill/session/virtual_hand.h"
#include "osteomill/visual/clip_face.h"
#include "osteomill/volume/isovalue.h"

#include "app/branch_options.h"
#include "app/device_option.h"
#include "app/scan_options.h"
#include "app/simulate/autosave.h"
#include "app/simulate/bone_view.h"
#include "app/simulate/exercise_work.h"
#include "app/simulate/playback.h"

namespace osteomill::app {

/// A scan that is open, and what the window shows of it beside its surface.
struct ScanInfo {
  std::string name;
  ScanOptions source;
  /// The isovalue it was opened with, where that came from, half a sentence, and " HU" if that is its
  /// unit.
  double isovalue;
  std::string isovalue_from;
  std::string unit;
  BoneBox box;
  DensityHistogram histogram;
  std::vector<Boundary> boundaries;
  WindowLevel grey_window;
  /// Null if the bone has none.
  std::shared_ptr<const LabelMap> labels;
};

/// A scan that was opened and made ready for milling, but is not milled yet.
struct PreparedScan {
  ScanInfo scan;
  PreparedMilling milling;
  /// Null if no exercise is worked on.
  std::unique_ptr<ExerciseWork> exercise;
  /// Given if it goes on from a recording.
  std::optional<BranchPoint> from = {};
  /// The file that already keeps what was milled of it, if any.
  std::optional<AutosaveFile> milled_file = {};
  /// A recording that is to be played from this time of it, s; nothing is then milled.
  std::unique_ptr<Playback> playback = {};
  double play_at_s = 0;
  /// The series that a folder holds, if there are several and none was named. Nothing else was then read.
  std::vector<SeriesSummary> series = {};
};

/// Who holds the tool: hardware, which outlives the simulation, or a hand without hardware of this name.
struct ToolSource {
  std::string name = kMouse;
  ConnectedDevice* hardware = nullptr;

  /// Returns whether mouse, keyboard or SpaceMouse move the tool.
  bool is_pointer() const { return hardware == nullptr && name != kSimulated; }
};

/// A scan that is being milled; one at a time.
struct Simulation {
  /// The tool begins at `X_WT`; with the simulated operator where they begin.
  Simulation(PreparedScan opened, const Pose& X_WT, const ToolSource& tool_source,
             const std::string& command_line);

  /// Begins to tick.
  void start();
  /// Calls LiveMilling::update, and updates the ticks' history, the counts and the autosave. Call once for
  /// each picture.
  void update();
  /// Returns how many ticks the history has once it is full.
  std::size_t max_history() const;
  /// Returns what a recording that is begun now says about it.
  RunDescription describe() const;

  /// Returns the labels that colour the bone: the exercise's, or else the bone's own.
  const std::shared_ptr<const LabelMap>& shown_labels() const {
    return exercise ? exercise->colours() : scan.labels;
  }
  /// Returns whether labels colour the bone now.
  bool shows_labels(const ViewState& view) const {
    return view.labels && (!exercise || exercise->has_guidance());
  }

  ScanInfo scan;
  std::unique_ptr<ExerciseWork> exercise;
  std::optional<BranchPoint> from;
  std::string command_line;
  /// Warnings about this isovalue, tool and settings (isovalue_warnings,
  /// coarseness_warnings, setting_warnings).
  std::vector<std::string> warnings;
  ToolSource tool_source;
  /// Holds the tool where mouse, keyboard or SpaceMouse move it.
  VirtualHand hand;
  std::optional<SimulatedOperator> simulated;
  /// The one of hardware, `hand` and `simulated` that holds the tool.
  Device& device;
  LiveMilling milling;
  Autosave autosave;
  /// The labels that the burr met, and how much of each has gone (LiveMilling::removed_by_label).
  LabelCount label_count;
  std::vector<double> removed_by_label_mm3;
  /// The text to show on the no-go contact that began last.
  std::string no_go_text;
  /// The ticks of the last 5 seconds.
  std::deque<TickRecord> history;

 private:
  Device& take_tool(const MillingSetup& setup, const Volume& bone, const Pose& X_WT);
  void count_labels();
  void update_warnings();

  // The isovalue, the burr's radius (mm) and the lines of setting_warnings that the warnings are for.
  std::optional<std::tuple<double, double, std::vector<std::string>>> warned_inputs_;
  std::future<std::vector<std::string>> pending_warnings_;
  std::uint64_t counted_version_ = 0;
  std::chrono::steady_clock::time_point counted_;
};

}  // namespace osteomill::app
