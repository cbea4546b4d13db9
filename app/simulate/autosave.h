#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "app/scan_options.h"

#include "osteomill/live/live_milling.h"
#include "osteomill/recording/recording.h"

namespace osteomill::app {

/// The name of a recording of milled bone in the user's state folder, this object's alone for as long as it
/// lives: a lock goes with it that the system takes away however the program ends, so that windows which are
/// open at the same time never touch each other's. What the file holds stays when the object goes.
class AutosaveFile {
 public:
  /// A new name; nothing where the folder cannot be made or written, or the user has none.
  static std::optional<AutosaveFile> make();
  /// This one; nothing where another has it.
  static std::optional<AutosaveFile> locked(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  /// Removes what it holds.
  void clear() const;

 private:
  AutosaveFile(std::filesystem::path path, int lock);

  std::filesystem::path path_;
  // Gives it up as it goes.
  std::shared_ptr<void> lock_;
};

/// What a program left that has ended, and what it is of.
struct LeftMilling {
  AutosaveFile file;
  SessionStart start;
};
/// The last one; nothing where there is none.
std::optional<LeftMilling> last_left_milling();
/// The scan of which it was milled, with all that it took to open it.
ScanOptions scan_of(const SessionStart& left);

/// Keeps what was milled and not saved in such a file, a few seconds behind: the first time at once, then no
/// oftener than every 5 s and for no more than 2 % of the time: a recording of no ticks, with the bone as it
/// is. Reads the follower's copy and writes in a thread of its own.
class Autosave {
 public:
  /// What is milled of this scan; in `file`, or in a new one.
  Autosave(ScanOptions scan, std::optional<AutosaveFile> file);
  ~Autosave();

  /// Once a picture. Where nothing is milled that is not saved there is no file either.
  void update(LiveMilling& milling);
  /// The bone as it was at this version is saved.
  void saved(std::uint64_t bone_version) { saved_version_ = bone_version; }
  /// Whether bone was milled that is not saved.
  bool unsaved(const LiveMilling& milling) const {
    return milling.follower().touched() && milling.follower().version() != saved_version_;
  }
  /// The user lets it go.
  void discard();
  /// Why there is no autosave, once; else empty.
  std::string take_complaint() { return std::exchange(complaint_, {}); }

 private:
  using Clock = std::chrono::steady_clock;
  void take_result();

  ScanOptions scan_;
  std::optional<AutosaveFile> file_;
  std::uint64_t saved_version_ = 0;
  std::uint64_t kept_version_ = 0;
  bool kept_ = false;
  Clock::time_point next_;
  std::string complaint_;
  // How long it took.
  std::future<Clock::duration> work_;
};

}  // namespace osteomill::app
