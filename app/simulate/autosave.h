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

/// A file for milled bone in a folder of its own in the user's state folder. Locked for the lifetime of this
/// object, so that concurrent windows never use each other's file; the system releases the lock however the
/// program ends. Does not remove the file at the end.
class AutosaveFile {
 public:
  /// Creates a file in a new folder; std::nullopt if that fails or the user has no state folder.
  static std::optional<AutosaveFile> make();
  /// Locks the file in this folder; std::nullopt if another process holds it.
  static std::optional<AutosaveFile> try_lock(const std::filesystem::path& folder);

  std::filesystem::path path() const { return folder_ / "milled.h5"; }
  /// Removes the file and the partial files of a process killed while writing.
  void clear() const;

 private:
  AutosaveFile(std::filesystem::path folder, FileLock lock);

  std::filesystem::path folder_;
  // On destruction unlocks the folder, and removes it if it is empty.
  std::shared_ptr<FileLock> lock_;
};

/// Unsaved milled bone autosaved by an earlier run of the program.
struct LeftoverMilling {
  AutosaveFile file;
  SessionStart start;
};
/// Returns the newest one not locked by another process; std::nullopt if there is none.
std::optional<LeftoverMilling> last_leftover_milling();

/// Autosaves unsaved milled bone as a recording without ticks: at once after the first change, then at most
/// every 5 s and for at most 2 % of the time. Reads the follower's copy and writes on a thread of its own.
class Autosave {
 public:
  /// Autosaves the milling of this scan to `file`, or to a new file if none is given.
  Autosave(ScanOptions scan, std::optional<AutosaveFile> file);

  /// Call once per frame. Removes the file if nothing is unsaved.
  void update(LiveMilling& milling);
  /// Notes that the user saved this version of the bone (BoneFollower::version).
  void mark_saved(std::uint64_t bone_version) { saved_version_ = bone_version; }
  /// Returns whether there is unsaved milling.
  bool has_unsaved(const LiveMilling& milling) const {
    return milling.follower().is_touched() && milling.follower().version() != saved_version_;
  }
  /// Removes the file because the user discarded the milling.
  void discard();
  /// Returns the reason why autosaving fails, once; otherwise an empty string.
  std::string take_error() { return std::exchange(error_, {}); }

 private:
  using Clock = std::chrono::steady_clock;
  void take_result();

  ScanOptions scan_;
  std::optional<AutosaveFile> file_;
  std::uint64_t saved_version_ = 0;
  std::uint64_t autosaved_version_ = 0;
  bool kept_ = false;
  Clock::time_point next_;
  std::string error_;
  // Running write; returns how long it took. Last, so that its destructor waits for it first.
  std::future<Clock::duration> work_;
};

}  // namespace osteomill::app
