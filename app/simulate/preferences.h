#pragma once

#include <chrono>
#include <future>
#include <string>

#include "osteomill/base/field.h"
#include "osteomill/session/milling_setup.h"

#include "app/simulate/theme.h"

namespace osteomill::app {

/// Position and size of a window, in screen pixels.
struct WindowPlace {
  int left = 0, top = 0;
  /// Zero if unknown.
  int width = 0, height = 0;
  friend bool operator==(const WindowPlace&, const WindowPlace&) = default;
};

/// Everything the window remembers for this user between sessions. Each value is listed once, in `fields_of`,
/// with its name in the file.
struct Preferences {
  WindowPlace place;
  /// Scale of the text; 0 follows the screen.
  double text_scale = 0;
  Theme theme = Theme::dark;
  bool ghost = true;
  bool arrows = true;
  bool see_through = false;
  bool labels = true;
  bool sound = true;
  bool follow_burr = false;
  bool loupe = false;
  /// Magnification of the loupe relative to the view.
  float loupe_power = 2;
  /// The help page was shown; from then on it appears only on F1.
  bool help_seen = false;
  /// Whether each group of controls or panel is expanded.
  struct Open {
    bool controls = true, readings = true;
    bool milling = true, view = true, files = true, closer = false, bone = false, cuts = false;
    /// Whether the laboratory group is expanded, then each of its groups.
    bool laboratory = false;
    bool algorithm = true, tool = true, drive = false;
    /// All measures in the results of an exercise.
    bool measures = false;
  };
  Open open;
  /// Folder from which a scan was last opened; empty if none.
  std::string last_folder;
  /// Burr, shaft and drive that were last chosen; the other fields are not used.
  MillingSetup tool;
};

/// Copies burr, shaft and drive. Returns whether any of them changed.
bool copy_tool(const MillingSetup& from, MillingSetup& to);

/// Reads the preferences. Returns the defaults if there is no file, or, with one line on standard error, if
/// it is damaged or has a value out of range.
Preferences read_preferences();

/// Returns the preferences in the format of the file.
std::string preferences_text(const Preferences& preferences);

/// Writes such a text atomically, so that of two windows that write at once, the file of one is kept whole.
/// Does nothing if there is no state folder or it cannot be written.
void write_preferences(const std::string& text);

/// Writes the preferences when they change, on a thread of its own, so that no frame waits for the disk. For
/// one thread.
class PreferencesKeeper {
 public:
  /// `now` are the preferences as read.
  explicit PreferencesKeeper(const Preferences& now) : kept_(preferences_text(now)) {}
  /// Writes changed preferences if the last write was long enough ago. Call once per frame.
  void keep(const Preferences& preferences);
  /// Writes changed preferences and waits until they are written.
  void keep_now(const Preferences& preferences);

 private:
  std::string kept_;
  std::chrono::steady_clock::time_point next_;
  std::future<void> writing_;
};

}  // namespace osteomill::app
