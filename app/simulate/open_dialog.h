#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/ct/read_scan.h"

#include "app/simulate/dialogues.h"
#include "app/simulate/folder_listing.h"
#include "app/simulate/portal_dialog.h"

namespace osteomill::app {

/// Kind of object requested by a button.
enum class OpenKind { none, file, folder };

/// Draws the buttons for opening a file or folder. Returns the one pressed.
OpenKind draw_open_buttons();

/// Lets the user choose a scan or recording: in the desktop's file dialog if available, else in its own,
/// which also lists recent scans. Its own folders are listed on another thread.
class OpenDialog {
 public:
  /// Draws one frame of the dialog; `request` opens it. Returns the chosen file or folder. Draws nothing
  /// while another dialogue is waiting. Starts in `last_folder` and sets it to the folder of the chosen file.
  std::optional<std::string> draw(OpenKind request, bool is_waiting, std::string& last_folder);
  bool is_shown() const { return is_shown_; }

 private:
  void begin(OpenKind request, const std::string& last_folder);
  void show();
  void go_to(const std::filesystem::path& folder);
  void enter(const FolderListing::Entry& entry);
  void take_listing();
  void take_keys();
  void draw_places();
  void draw_files();

  PortalDialog portal_;
  FolderReader reader_;
  FolderListing listing_;
  std::vector<std::string> recent_;
  std::filesystem::path folder_;
  std::array<char, 4096> path_{};
  int selected_ = -1;
  bool is_shown_ = false;
  bool is_scrolled_to_ = false;
  std::optional<std::string> chosen_;
};

/// Asks which series of a folder to open, one line each: number, name, slices and thickness.
Dialogue series_question(const std::string& scan, const std::vector<SeriesSummary>& series,
                         const std::function<void(const std::string& number)>& open, Dialogue::Action cancel);

}  // namespace osteomill::app
