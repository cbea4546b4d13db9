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

/// An open scan, with the data that the window shows besides its surface.
struct ScanInfo {
  std::string name;
  ScanOptions source;
  /// The initial isovalue, how it was determined (half a sentence), and " HU" if that is its unit.
  double isovalue;
  std::string isovalue_from;
  std::string unit;
  BoneBox box;
  DensityHistogram histogram;
  std::vector<Boundary> boundaries;
  WindowLevel grey_window;
  /// Null if the bone has no labels.
  std::shared_ptr<const LabelMap> labels;
};

/// A scan that was opened and prepared for milling.
struct PreparedScan {
  ScanInfo scan;
  PreparedMilling milling;
  /// Null without an exercise.
  std::unique_ptr<ExerciseWork> exercise;
  /// Set if milling continues from a recording.
  std::optional<BranchPoint> from = {};
  /// The autosave file that already holds its milling, if any.
  std::optional<AutosaveFile> milled_file = {};
  /// A recording to play from `play_at_s`; nothing is milled then.
  std::unique_ptr<Playback> playback = {};
  double play_at_s = 0;
  /// The series of a folder, if there are several and none was named; the scan itself was then not read.
  std::vector<SeriesSummary> series = {};
};

/// Holder of the tool: hardware, which must outlive the simulation, or a virtual hand of this name.
struct ToolSource {
  std::string name = kMouse;
  ConnectedDevice* hardware = nullptr;

  /// Returns whether mouse, keyboard or SpaceMouse move the tool.
  bool is_pointer() const { return hardware == nullptr && name != kSimulated; }
};

/// A scan being milled; only one at a time.
struct Simulation {
  /// The tool starts at `X_WT`, or with the simulated operator where that starts.
  Simulation(PreparedScan opened, const Pose& X_WT, const ToolSource& tool_source,
             const std::string& command_line);

  /// Starts ticking.
  void start();
  /// Calls LiveMilling::update, and updates the history of ticks, the counts and the autosave. Call once per
  /// frame.
  void update();
  /// Returns the capacity of the history, ticks.
  std::size_t max_history() const;
  /// Returns the description for a recording that starts now.
  RunDescription describe() const;

  /// Returns the labels that colour the bone: the exercise's, or else the bone's own.
  const std::shared_ptr<const LabelMap>& shown_labels() const {
    return exercise ? exercise->colours() : scan.labels;
  }
  /// Returns whether labels colour the bone now.
  bool has_visible_labels(const ViewState& view) const {
    return view.labels && (!exercise || exercise->has_guidance());
  }

  ScanInfo scan;
  std::unique_ptr<ExerciseWork> exercise;
  std::optional<BranchPoint> from;
  std::string command_line;
  /// Warnings about isovalue, tool and settings (isovalue_warnings, coarseness_warnings, setting_warnings).
  std::vector<std::string> warnings;
  ToolSource tool_source;
  /// Holds the tool if mouse, keyboard or SpaceMouse move it.
  VirtualHand hand;
  std::optional<SimulatedOperator> simulated;
  /// Refers to the active one of hardware, `hand` and `simulated`.
  Device& device;
  LiveMilling milling;
  Autosave autosave;
  /// Labels touched by the burr, and the removed volume of each (LiveMilling::removed_by_label).
  LabelCount label_count;
  std::vector<double> removed_by_label_mm3;
  /// Text on the latest no-go contact.
  std::string no_go_text;
  /// Ticks of the last 5 seconds.
  std::deque<TickRecord> history;

 private:
  Device& take_tool(const MillingSetup& setup, const Volume& bone, const Pose& X_WT);
  void count_labels();
  void update_warnings();

  // Isovalue, burr radius (mm) and lines of setting_warnings for which the warnings were computed.
  std::optional<std::tuple<double, double, std::vector<std::string>>> warned_inputs_;
  std::future<std::vector<std::string>> pending_warnings_;
  std::uint64_t counted_version_ = 0;
  std::chrono::steady_clock::time_point counted_;
};

}  // namespace osteomill::app
