#pragma once

#include <chrono>
#include <future>
#include <string>

#include "osteomill/base/field.h"
#include "osteomill/session/milling_setup.h"

#include "app/simulate/theme.h"

namespace osteomill::app {

/// The place of a window on the screens, in their pixels.
struct WindowPlace {
  int left = 0, top = 0;
  /// Zero if it is not known.
  int width = 0, height = 0;
  friend bool operator==(const WindowPlace&, const WindowPlace&) = default;
};

/// All that the window keeps for this user from one start to the next. `fields_of` lists each value once,
/// with its name in the file.
struct Preferences {
  WindowPlace place;
  /// How much larger than usual text is; 0: as the screen asks for.
  double text_scale = 0;
  Theme theme = Theme::dark;
  bool ghost = true;
  bool arrows = true;
  bool see_through = false;
  bool labels = true;
  bool sound = true;
  bool follow_burr = false;
  bool loupe = false;
  /// How much larger the loupe shows the bone than the view.
  float loupe_power = 2;
  /// The page that explains the controls was shown, and comes by F1 alone.
  bool help_seen = false;
  /// Whether a group of controls, or a panel, is more than its title.
  struct Open {
    bool controls = true, readings = true;
    bool milling = true, view = true, files = true, closer = false, bone = false, cuts = false;
    /// The laboratory's groups are there at all, and each of them.
    bool laboratory = false;
    bool algorithm = true, tool = true, drive = false;
    /// All measures in the results of an exercise.
    bool measures = false;
  };
  Open open;
  /// The folder from which a scan was opened last; empty if there is none.
  std::string last_folder;
  /// The burr, its shaft and its drive that were chosen last; nothing else of it counts.
  MillingSetup tool;
};

/// Copies burr, shaft and drive. Returns whether any of them was another.
bool copy_tool(const MillingSetup& from, MillingSetup& to);

/// Reads what was kept. Without a file, and, with one line on standard error, if the file is damaged or has a
/// value out of range: the defaults.
Preferences read_preferences();

/// Returns the preferences as a file has them.
std::string preferences_text(const Preferences& preferences);

/// Writes such a text in one step, so that two windows that write at once leave the whole file of one of
/// them. Does nothing without a folder for the user's state, or if that cannot be written.
void write_preferences(const std::string& text);

/// Writes the preferences as they change, on a thread of its own, so that no picture waits for the disk. For
/// one thread.
class PreferencesKeeper {
 public:
  /// `now`: as they were read.
  explicit PreferencesKeeper(const Preferences& now) : kept_(preferences_text(now)) {}
  /// Writes them if they changed and the last time is a while ago. Call once for each picture.
  void keep(const Preferences& preferences);
  /// Writes them if they changed, and waits for it.
  void keep_now(const Preferences& preferences);

 private:
  std::string kept_;
  std::chrono::steady_clock::time_point next_;
  std::future<void> writing_;
};

}  // namespace osteomill::app
