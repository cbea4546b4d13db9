#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <optional>
#include <string>

#include "osteomill/visual/camera.h"
#include "osteomill/visual/image.h"

#include "app/simulate/simulation.h"
#include "app/simulate/view_state.h"

namespace osteomill::app {

/// Recording, reports, and what can be saved, all into one folder. Files are named after the time and this
/// process, so that several windows may share the folder. What takes long is done on a thread of its own.
class FilesPanel {
 public:
  /// The view as from a camera.
  using TakePicture = std::function<Image(const Camera&)>;
  FilesPanel(std::filesystem::path folder, TakePicture take_picture)
      : folder_(std::move(folder)), take_picture_(std::move(take_picture)) {}

  void draw(ViewState& view, Simulation& simulation);
  /// Draws, at the bottom of the right column, where it is always in sight, the work in progress, the last
  /// result, and buttons that open its file. Returns its upper edge, pixels from the top of the window.
  float draw_message(ViewState& view, const Simulation& simulation, const PixelSize& size);
  /// Ends a recording that still goes on, and waits until everything is written.
  void close(ViewState& view, Simulation& simulation);
  /// Begins a recording, unless one goes on; its name ends in `what`.
  void begin_recording(ViewState& view, Simulation& simulation, const std::string& what);
  /// Ends a recording that still goes on.
  void end_recording(ViewState& view, Simulation& simulation);
  bool is_busy() const { return work_.valid(); }
  /// Returns whether the last file was written without an error.
  bool is_written() const { return is_written_; }
  /// Returns whether there is a recording without a report.
  bool has_unreported(const Simulation& simulation) const {
    return simulation.milling.is_recording() || last_recording_ != reported_;
  }
  /// Ends a recording that goes on and begins the report of the last one. Not while busy.
  void end_with_report(ViewState& view, Simulation& simulation);
  /// Begins to write the milled bone. Not while busy.
  void save_scan(ViewState& view, Simulation& simulation);
  /// Writes a picture of the window.
  void save_picture(ViewState& view, const Image& picture) const;
  /// Writes a text to a file whose name ends in `what`.
  void save_text(ViewState& view, const std::string& what, const std::string& text) const;
  /// Tells in the view how writing went, once it has ended.
  void take_result(ViewState& view, Simulation& simulation);
  /// Returns the length of the running recording, s; nothing if none runs.
  std::optional<double> recording_s(const Simulation& simulation) const;
  const std::filesystem::path& last_recording() const { return last_recording_; }
  /// A new name in the folder.
  std::filesystem::path name(const std::string& what) const;

 private:
  void record(ViewState& view, Simulation& simulation, const std::string& what = "recording.h5");
  /// Begins to write this file.
  template <typename Write>
  void begin(const std::filesystem::path& path, Write write);
  void make_report();

  std::filesystem::path folder_;
  TakePicture take_picture_;
  std::filesystem::path last_recording_;
  // The last recording of which there is a report.
  std::filesystem::path reported_;
  bool is_written_ = false;
  struct WriteResult {
    std::string message;
    std::filesystem::path result;
    /// The recording of which the result is the report; empty for any other file.
    std::filesystem::path recording;
  };
  std::chrono::steady_clock::time_point recording_since_;
  // The time at which a recording begins that goes on from another.
  double recorded_before_s_ = 0;
  std::future<WriteResult> work_;
  // The version of the bone that is being saved (BoneFollower::version).
  std::optional<std::uint64_t> saving_version_;
};

}  // namespace osteomill::app
