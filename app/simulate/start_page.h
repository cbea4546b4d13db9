#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/visual/camera.h"
#include "osteomill/visual/picture_texture.h"

#include "app/simulate/open_dialog.h"

namespace osteomill::app {

/// The choice of a user on the start page: an exercise with a name to record, or a scan.
struct StartChoice {
  std::string exercise;
  std::string trainee;
  std::string scan;
  OpenKind open = OpenKind::none;
};

/// The page that the window opens with if neither a scan nor an exercise was named.
class StartPage {
 public:
  /// Reads the exercises that come along, and their pictures. The window's OpenGL context is current.
  StartPage();

  /// Draws the page. Returns what was chosen; nothing in most pictures.
  std::optional<StartChoice> draw(const PixelSize& size);

 private:
  struct Entry {
    std::string file;
    std::string title;
    std::string task;
    std::unique_ptr<PictureTexture> picture;
    float width_by_height = 1;
  };
  void add_exercise(const std::filesystem::path& file);
  bool draw_entry(const Entry& entry, float width_px) const;
  void draw_exercises(std::optional<StartChoice>& choice);
  void draw_scans(std::optional<StartChoice>& choice);

  std::vector<Entry> entries_;
  std::vector<std::string> recent_;
  std::array<char, 256> name_{};
};

/// Returns the folder of the exercises that come along: beside the program or in a folder above it, or where
/// the documents are installed; empty if there is none.
std::filesystem::path exercises_folder();

/// Returns the scans that were opened last, the newest first, as far as they are still there.
std::vector<std::string> recent_scans();
/// Puts a scan at the head of those. Does nothing without a folder for the user's state.
void note_recent_scan(const std::string& scan);

}  // namespace osteomill::app
