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

/// The user's choice on the start page: a scan, recording or exercise, or to choose one in a dialog.
struct StartChoice {
  std::string path;
  OpenKind open = OpenKind::none;
};

/// The page shown if neither a scan nor an exercise was named.
class StartPage {
 public:
  /// Reads the included exercises and their pictures. `trainee` is the name shown at first. The window's
  /// OpenGL context must be current.
  explicit StartPage(const std::string& trainee);

  /// Draws the page. Returns the user's choice; std::nullopt in most frames.
  std::optional<StartChoice> draw(const PixelSize& size);

  /// Returns the name shown, which an exercise records; may be empty.
  std::string trainee() const { return name_.data(); }

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

/// Returns the folder of the included exercises: next to the program, in a folder above it, or with the
/// installed documents; empty if there is none.
std::filesystem::path exercises_folder();

/// Returns the scans opened most recently, newest first, without those that no longer exist.
std::vector<std::string> recent_scans();
/// Puts a scan at the head of that list. Does nothing without a state folder.
void note_recent_scan(const std::string& scan);

}  // namespace osteomill::app
