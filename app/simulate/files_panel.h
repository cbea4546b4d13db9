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

/// Recording, reports and saving, all into one folder. File names contain the time and the process number, so
/// that several windows can share the folder. Long work runs on a thread of its own.
class FilesPanel {
 public:
  /// Renders the view from a camera.
  using TakePicture = std::function<Image(const Camera&)>;
  FilesPanel(std::filesystem::path folder, TakePicture take_picture)
      : folder_(std::move(folder)), take_picture_(std::move(take_picture)) {}

  void draw(ViewState& view, Simulation& simulation);
  /// Draws, always visible at the bottom of the right column, the work in progress, the last result and
  /// buttons that open its file. Returns its upper edge, pixels from the top of the window.
  float draw_message(ViewState& view, const Simulation& simulation, const PixelSize& size);
  /// Ends a running recording and waits until everything is written.
  void close(ViewState& view, Simulation& simulation);
  /// Starts a recording, unless one is running; its file name ends in `what`.
  void begin_recording(ViewState& view, Simulation& simulation, const std::string& what);
  /// Ends a running recording.
  void end_recording(ViewState& view, Simulation& simulation);
  bool is_busy() const { return work_.valid(); }
  /// Returns whether the last file was written without error.
  bool is_written() const { return is_written_; }
  /// Returns whether there is a recording without a report.
  bool has_unreported(const Simulation& simulation) const {
    return simulation.milling.is_recording() || last_recording_ != reported_;
  }
  /// Ends a running recording and starts writing the report of the last one. Do not call while busy.
  void end_with_report(ViewState& view, Simulation& simulation);
  /// Starts writing the milled bone. Do not call while busy.
  void save_scan(ViewState& view, Simulation& simulation);
  /// Saves a picture of the window.
  void save_picture(ViewState& view, const Image& picture) const;
  /// Saves text in a file whose name ends in `what`.
  void save_text(ViewState& view, const std::string& what, const std::string& text) const;
  /// Puts the result of finished writing into the view's message.
  void take_result(ViewState& view, Simulation& simulation);
  /// Returns the length of the running recording, s; std::nullopt if none is running.
  std::optional<double> recording_s(const Simulation& simulation) const;
  const std::filesystem::path& last_recording() const { return last_recording_; }
  /// Returns a new file name in the folder.
  std::filesystem::path name(const std::string& what) const;

 private:
  void record(ViewState& view, Simulation& simulation, const std::string& what = "recording.h5");
  /// Starts writing this file.
  template <typename Write>
  void begin(const std::filesystem::path& path, Write write);
  void make_report();

  std::filesystem::path folder_;
  TakePicture take_picture_;
  std::filesystem::path last_recording_;
  // Last recording for which a report was written.
  std::filesystem::path reported_;
  bool is_written_ = false;
  struct WriteResult {
    std::string message;
    std::filesystem::path result;
    /// If the result is a report, its recording; otherwise empty.
    std::filesystem::path recording;
  };
  std::chrono::steady_clock::time_point recording_since_;
  // Start time of a recording that continues another.
  double recorded_before_s_ = 0;
  std::future<WriteResult> work_;
  // Version of the bone being saved (BoneFollower::version).
  std::optional<std::uint64_t> saving_version_;
};

}  // namespace osteomill::app
