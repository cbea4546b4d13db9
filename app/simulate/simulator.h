#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "osteomill/session/milling_setup.h"

#include "app/branch_options.h"
#include "app/device_option.h"
#include "app/exercise_options.h"
#include "app/milling_options.h"
#include "app/scan_options.h"
#include "app/simulate/dialogues.h"
#include "app/simulate/milling_screen.h"
#include "app/simulate/open_dialog.h"
#include "app/simulate/opening.h"
#include "app/simulate/playback_screen.h"
#include "app/simulate/preferences.h"
#include "app/simulate/stage.h"
#include "app/simulate/start_page.h"
#include "app/simulate/window_driver.h"

namespace osteomill::app {

struct SimulatorOptions {
  ScanOptions scan;
  ExerciseOptions exercise;
  BranchOptions from;
  MillingOptions milling;
  DeviceOption device{kMouse};
  SendOption send;
  /// Scale of the text; unset: follows the screen.
  std::optional<double> ui_scale;
  /// Null if a person operates the window.
  WindowDriver* driver = nullptr;
  bool no_help = false;
  /// Folder for recordings and saved files.
  std::string folder = ".";
  std::string command_line;
  Preferences remembered;
  /// No option named a tool, so the remembered one may be used.
  bool is_tool_free = true;
};

/// Controls the window from opening to closing: which screen is shown, what is opened next, and that no
/// unsaved work is lost.
class Simulator {
 public:
  explicit Simulator(const SimulatorOptions& options);

  /// Returns when the window is closed. Throws InputError if the named scan, recording or exercise cannot be
  /// opened.
  void run();

 private:
  bool is_driven() const;
  bool is_opening() const { return opening_.is_begun() || opened_; }
  bool is_settled();
  Simulation* simulation() { return milling_ ? &milling_->simulation() : nullptr; }

  void draw_screen();
  void draw_start_page();
  void draw_waiting();
  void draw_playback();
  void draw_milling();
  void draw_opening();
  void begin_picture();
  void finish_picture();

  void open_first();
  void begin_opening(OpenRequest request);
  void begin_file(const std::string& path);
  void begin_exercise(ExerciseOptions exercise);
  OpenRequest scan_request(const std::string& path) const;
  void ask_about_leftover();
  void open_leftover();
  void open_another();
  void cancel_opening();
  void note_opening_cancelled(const std::string& what);
  bool ask_for_series();
  void draw_open_dialog();
  void install_first();
  void install_opened();
  void leave_scan(const ScanInfo& next);
  void begin_milling(PreparedScan opened);
  void show_start_page();

  bool has_unsaved();
  void ask_before(const char* what, const Dialogue::Action& on_proceed, const Dialogue::Action& stay = {});
  void after_writing(const char* doing, const Dialogue::Action& then);
  void write(const char* doing, const Dialogue::Action& begin, const Dialogue::Action& then,
             const Dialogue::Action& stay);
  bool update_closing();
  void close();
  void close_exercise();
  void close_when_measured();
  void print_results();

  SimulatorOptions options_;
  // Setup for the first scan.
  MillingSetup setup_;
  std::unique_ptr<ConnectedDevice> hardware_;
  Stage stage_;
  PreferencesKeeper keeper_;
  Opening opening_;
  // Waits for the user's decision on the milled scan.
  std::optional<PreparedScan> opened_;
  int changes_before_ = 0;
  // Milled bone of an earlier run, offered to the user.
  std::optional<LeftoverMilling> leftover_;
  bool closing_ = false;
  bool reported_ = false;
  std::chrono::steady_clock::time_point last_picture_ = std::chrono::steady_clock::now();
  // The current screen: none until something is opened. Milling is last because its ticks refer to the
  // members above.
  std::optional<StartPage> start_page_;
  OpenDialog open_dialog_;
  std::unique_ptr<PlaybackScreen> playback_;
  std::unique_ptr<MillingScreen> milling_;
};

}  // namespace osteomill::app
