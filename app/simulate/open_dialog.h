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

/// The kind of thing that a button asked to be opened.
enum class OpenKind { none, file, folder };

/// Draws the buttons that ask for a file or folder to be opened. Returns what was asked for.
OpenKind draw_open_buttons();

/// Lets the user choose a scan or recording: by the desktop's dialog if there is one, else by one of its own,
/// with the scans that were opened last. Its own folder is listed on another thread.
class OpenDialog {
 public:
  /// Draws one picture of it; `request` begins it. Returns the file or folder that was chosen. Draws nothing
  /// while another dialogue is waiting. It begins in `last_folder`, and leaves there the folder of what was
  /// chosen.
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

/// Asks which series of a folder is to be opened, with a line for each: number, name, slices and thickness.
Dialogue series_question(const std::string& scan, const std::vector<SeriesSummary>& series,
                         const std::function<void(const std::string& number)>& open, Dialogue::Action cancel);

}  // namespace osteomill::app
