#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace osteomill::app {

/// Subfolders of a folder, and files that may be scans or recordings.
struct FolderListing {
  struct Entry {
    std::string name;
    bool is_folder = false;
    friend bool operator==(const Entry&, const Entry&) = default;
  };
  std::filesystem::path folder;
  /// Folders first, then files, both sorted by name.
  std::vector<Entry> entries;
  /// Reason why the folder cannot be read, one line; empty if it can.
  std::string complaint;
  /// The path is a file, not a folder.
  bool is_file = false;
  /// The folder holds more entries than are listed.
  bool has_more = false;
};

/// Maximum number of entries listed; more would not be readable and would take seconds to sort and check.
inline constexpr std::size_t kMaxListed = 20'000;

/// Lists a folder without hidden files. Stops early once `is_stopped` is true. May block on slow file
/// systems.
FolderListing list_folder(const std::filesystem::path& folder, const std::atomic<bool>& is_stopped);

/// Lists folders on a thread of its own, which is abandoned if a file system does not respond. For one
/// thread.
class FolderReader {
 public:
  FolderReader() = default;
  ~FolderReader() { stop(); }
  FolderReader(const FolderReader&) = delete;
  FolderReader& operator=(const FolderReader&) = delete;

  /// Starts listing a folder; cancels a listing in progress.
  void begin(const std::filesystem::path& folder);
  bool is_reading() const { return work_ != nullptr; }
  /// Returns the listing once it is ready.
  std::optional<FolderListing> take();

 private:
  struct Work;
  void stop();
  std::shared_ptr<Work> work_;
};

}  // namespace osteomill::app
