#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "osteomill/base/file_lock.h"
#include "osteomill/live/live_milling.h"
#include "osteomill/recording/recording.h"

#include "app/scan_options.h"

namespace osteomill::app {

/// A file for milled bone in a folder of its own in the user's state folder, locked for as long as this
/// object lives, so that windows which are open at the same time never touch each other's. The system takes
/// the lock away however the program ends. The file itself stays.
class AutosaveFile {
 public:
  /// Makes a file in a new folder; nothing if that cannot be made, or the user has no state folder.
  static std::optional<AutosaveFile> make();
  /// Takes the file in this folder; nothing if another program has it locked.
  static std::optional<AutosaveFile> try_lock(const std::filesystem::path& folder);

  std::filesystem::path path() const { return folder_ / "milled.h5"; }
  /// Removes the file, and what a program left that was killed while it wrote.
  void clear() const;

 private:
  AutosaveFile(std::filesystem::path folder, FileLock lock);

  std::filesystem::path folder_;
  // Gives it up as it goes, and the folder with it if that is empty.
  std::shared_ptr<FileLock> lock_;
};

/// Milled bone that an earlier run of the program kept and the user did not save.
struct LeftoverMilling {
  AutosaveFile file;
  SessionStart start;
};
/// The newest that no other running program holds; nothing if there is none.
std::optional<LeftoverMilling> last_leftover_milling();

/// Keeps unsaved milled bone in such a file, as a recording of no ticks: the first time at once, then at most
/// every 5 s and for no more than 2 % of the time. Reads the follower's copy and writes on a thread of its
/// own.
class Autosave {
 public:
  /// Saves the milling of this scan. Writes to `file`, or to a new one if that is not given.
  Autosave(ScanOptions scan, std::optional<AutosaveFile> file);

  /// Call once for each picture. Removes the file if nothing is unsaved.
  void update(LiveMilling& milling);
  /// The bone of this version (BoneFollower::version) was saved by the user.
  void mark_saved(std::uint64_t bone_version) { saved_version_ = bone_version; }
  /// Returns whether bone was milled that is not saved.
  bool has_unsaved(const LiveMilling& milling) const {
    return milling.follower().is_touched() && milling.follower().version() != saved_version_;
  }
  /// Removes the file: the user does not want what was milled.
  void discard();
  /// Returns the reason why nothing can be kept, once; otherwise an empty text.
  std::string take_error() { return std::exchange(error_, {}); }

 private:
  using Clock = std::chrono::steady_clock;
  void take_result();

  ScanOptions scan_;
  std::optional<AutosaveFile> file_;
  std::uint64_t saved_version_ = 0;
  std::uint64_t kept_version_ = 0;
  bool kept_ = false;
  Clock::time_point next_;
  std::string error_;
  // The work under way, which returns how long it took. Last, so that it is waited for at the end.
  std::future<Clock::duration> work_;
};

}  // namespace osteomill::app
